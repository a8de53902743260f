// Volumes that are read by bricks: files, and arrays whose parts Python hands over when they are asked for.
#include <algorithm>
#include <cstring>

#include "binding.h"

namespace chiaro::python {
namespace {

using Size = std::array<int, 3>;

/// Chunks of arrays, one array a level. Python is asked for boxes within a level, one at a time.
class ArrayChunks final : public ChunkReader {
public:
    /// `read(level, first, end)`, both (x, y, z), gives an array (z, y, x) in C order, of the header's type.
    ArrayChunks(Volume header, std::vector<ChunkedLevel> levels, py::object read)
        : header_(std::move(header)), levels_(std::move(levels)), read_(kept(std::move(read))) {}

    const Volume& header() const override { return header_; }
    const std::vector<ChunkedLevel>& levels() const override { return levels_; }

    void decode(int level, const Size& chunk, const Use& use) override {
        const ChunkedLevel& grid = levels_[std::size_t(level)];
        Size first{}, end{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            first[axis] = chunk[axis] * grid.chunk[axis];
            end[axis] = std::min(first[axis] + grid.chunk[axis], grid.dimensions[axis]);
        }
        std::vector<std::byte> voxels(grid.chunk_voxels() * size_of(header_.type));
        fetch(level, first, end, grid.chunk, voxels);
        use(voxels, true);
    }

private:
    void fetch(int level, const Size& first, const Size& end, const Size& chunk, std::vector<std::byte>& to) const {
        const py::gil_scoped_acquire lock;
        try {
            const py::handle read(static_cast<PyObject*>(const_cast<void*>(read_.get())));
            const py::buffer array = read(level, first, end);
            const py::buffer_info info = array.request();
            const std::size_t item = size_of(header_.type), row = std::size_t(end[0] - first[0]) * item;
            const int rows = end[1] - first[1], slices = end[2] - first[2];
            if (std::size_t(info.size * info.itemsize) != row * std::size_t(rows) * std::size_t(slices))
                throw Error(ErrorCode::internal, "a part of an array of another size than asked for");
            const auto* from = static_cast<const std::byte*>(info.ptr);
            for (int z = 0; z < slices; ++z)
                for (int y = 0; y < rows; ++y, from += row)
                    std::memcpy(to.data() + (std::size_t(z) * chunk[1] + y) * chunk[0] * item, from, row);
        } catch (py::error_already_set& raised) {
            const std::string told = raised.what();
            throw Error(ErrorCode::input,
                        header_.source + ": reading a part of it fails: " + told.substr(0, told.find('\n')));
        }
    }

    Volume header_;
    std::vector<ChunkedLevel> levels_;
    std::shared_ptr<const void> read_;
};

/// Everything but the voxels.
VolumeHandle header_of(const std::string& type, const Size& dimensions) {
    auto volume = std::make_shared<Volume>();
    volume->dimensions = dimensions;
    from_text(type, volume->type);
    return {volume};
}

SourceHandle source_of_arrays(const VolumeHandle& header, const std::vector<std::pair<Size, Size>>& shapes,
                              py::object read) {
    const Volume& whole = *header.volume;
    std::vector<ChunkedLevel> levels;
    for (const auto& [dimensions, chunk] : shapes) {
        Vec3 first, stride;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            stride[int(axis)] = double(whole.dimensions[axis]) / dimensions[axis];
            first[int(axis)] = (stride[int(axis)] - 1) / 2;
        }
        levels.push_back({dimensions, chunk, every(whole.geometry, stride, first)});
    }
    return {source_of_chunks(std::make_unique<ArrayChunks>(without_voxels(whole), std::move(levels), std::move(read)))};
}

std::optional<SourceHandle> source_of_file(const std::string& name, const Scene& scene, py::object report) {
    auto source = result_of({report}, [&](Progress&, News&) { return open_brick_source(name, scene.read); });
    if (!source) return {};
    return SourceHandle{source};
}

}  // namespace

void add_lazy(py::module_& module) {
    py::class_<SourceHandle>(module, "Source")
        .def_property_readonly(
            "header",
            [](const SourceHandle& h) {
                return VolumeHandle{std::make_shared<const Volume>(without_voxels(h.source->header()))};
            })
        .def_property_readonly("levels",
                               [](const SourceHandle& h) {
                                   std::vector<Size> all;
                                   for (const SourceLevel& level : h.source->levels()) all.push_back(level.dimensions);
                                   return all;
                               })
        .def("read_level", [](const SourceHandle& h, int level, py::object report) {
            return VolumeHandle{result_of({report}, [&](Progress& progress, News&) {
                return std::make_shared<const Volume>(read_level(*h.source, level, progress));
            })};
        });
    module.def("header", header_of);
    module.def("source_of_arrays", source_of_arrays);
    module.def("source_of_file", source_of_file);
}

}  // namespace chiaro::python
