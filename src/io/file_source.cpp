#include "io/file_source.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

#include "core/text.h"
#include "core/truncated_file.h"
#include "io/helper_process.h"

namespace chiaro {
namespace {

/// Which voxels of the file a level has: first + i * stride, per axis.
struct Lattice {
    std::array<int, 3> first{0, 0, 0}, stride{1, 1, 1};
};

/// Numbers of up to 16 bits and floats are kept, all others become floats.
VoxelType kept_type(VoxelType type) { return size_of(type) <= 2 ? type : VoxelType::f32; }

/// Every second voxel of each axis whose voxels are not twice as wide as others already: so they become cubes.
Lattice halved(const Lattice& finer, const Geometry& geometry) {
    Lattice lattice = finer;
    for (int axis = 0; axis < 3; ++axis) {
        if (geometry.spacing_mm[axis] >= 2 * geometry.smallest_spacing_mm()) continue;
        lattice.stride[std::size_t(axis)] *= 2;
        lattice.first[std::size_t(axis)] = lattice.stride[std::size_t(axis)] / 2;
    }
    return lattice;
}

class FileSource final : public BrickSource {
public:
    FileSource(Volume header, std::vector<SourceLevel> levels, std::vector<Lattice> lattices, VoxelType file_type,
               const VoxelsInFile& voxels, Descriptor file)
        : BrickSource(std::move(header), std::move(levels)),
          lattices_(std::move(lattices)),
          file_type_(file_type),
          voxels_(voxels),
          file_(std::move(file)) {}

    void read(int level, const VoxelBox& box, std::byte* to) const override {
        with_voxel_type(file_type_, [&](auto stored) {
            with_voxel_type(header().type, [&](auto kept) {
                read_as<decltype(stored), decltype(kept)>(lattices_[std::size_t(level)], box, to);
            });
        });
    }

private:
    /// Row by row: what lies between the voxels of a row is read as well.
    template <class Stored, class Kept>
    void read_as(const Lattice& lattice, const VoxelBox& box, std::byte* to) const {
        Kept* out = reinterpret_cast<Kept*>(to);
        const auto place = [&](std::size_t axis, int i) {
            return std::uint64_t(lattice.first[axis] + std::int64_t(i) * lattice.stride[axis]);
        };
        const auto [nx, ny, nz] = header().dimensions;
        const auto step = std::size_t(lattice.stride[0]);
        std::vector<Stored> row((std::size_t(box.size[0]) - 1) * step + 1);
        for (int z = 0; z < box.size[2]; ++z)
            for (int y = 0; y < box.size[1]; ++y) {
                const std::uint64_t line = place(2, box.first[2] + z) * std::uint64_t(ny) + place(1, box.first[1] + y);
                read_bytes(row.data(), row.size() * sizeof(Stored),
                           (line * std::uint64_t(nx) + place(0, box.first[0])) * sizeof(Stored));
                for (int x = 0; x < box.size[0]; ++x) *out++ = Kept(native(row[std::size_t(x) * step]));
            }
    }

    template <class Stored>
    Stored native(Stored stored) const {
        if (!voxels_.big_endian || sizeof(Stored) == 1) return stored;
        auto* bytes = reinterpret_cast<std::byte*>(&stored);
        std::reverse(bytes, bytes + sizeof stored);
        return stored;
    }

    void read_bytes(void* to, std::size_t bytes, std::uint64_t at) const {
        for (std::size_t done = 0; done < bytes;) {
            const ssize_t n =
                pread(file_.number(), static_cast<char*>(to) + done, bytes - done, off_t(voxels_.offset + at + done));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0)
                throw Error(ErrorCode::input, "cannot read '" + one_line(voxels_.path.string()) +
                                                  "': " + (n < 0 ? "reading it fails half-way" : was_cut));
            done += std::size_t(n);
        }
    }

    std::vector<Lattice> lattices_;
    VoxelType file_type_;
    VoxelsInFile voxels_;
    Descriptor file_;
};

}  // namespace

std::shared_ptr<const BrickSource> open_file_source(const Volume& header, const VoxelsInFile& voxels) {
    Descriptor file(open(voxels.path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.number() < 0)
        throw Error(ErrorCode::input, "cannot read '" + one_line(voxels.path.string()) + "': it cannot be opened");
    std::vector<SourceLevel> levels{{header.dimensions, header.geometry}};
    std::vector<Lattice> lattices(1);
    while (*std::max_element(levels.back().dimensions.begin(), levels.back().dimensions.end()) >=
           2 * least_level_edge) {
        const Lattice lattice = halved(lattices.back(), levels.back().geometry);
        SourceLevel level;
        Vec3 first, stride;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int n = header.dimensions[axis], at = lattice.first[axis], by = lattice.stride[axis];
            level.dimensions[axis] = at < n ? (n - 1 - at) / by + 1 : 0;
            first[int(axis)] = at, stride[int(axis)] = by;
        }
        if (std::count(level.dimensions.begin(), level.dimensions.end(), 0)) break;
        level.geometry = every(header.geometry, stride, first);
        levels.push_back(level), lattices.push_back(lattice);
    }
    Volume kept;
    kept.dimensions = header.dimensions, kept.geometry = header.geometry, kept.type = kept_type(header.type);
    kept.slope = header.slope, kept.intercept = header.intercept;
    kept.source = header.source, kept.format = header.format, kept.modality = header.modality;
    kept.notes = header.notes, kept.key_values = header.key_values;
    return std::make_shared<FileSource>(std::move(kept), std::move(levels), std::move(lattices), header.type, voxels,
                                        std::move(file));
}

}  // namespace chiaro
