#include "io/file_source.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

#include "core/text.h"
#include "core/truncated_file.h"
#include "io/helper_process.h"
#include "io/lattice.h"

namespace chiaro {
namespace {

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
    /// Row by row: what lies between the voxels of a row is read as well. Rows that follow one another at once.
    template <class Stored, class Kept>
    void read_as(const Lattice& lattice, const VoxelBox& box, std::byte* to) const {
        Kept* out = reinterpret_cast<Kept*>(to);
        const auto place = [&](std::size_t axis, int i) {
            return std::uint64_t(lattice.first[axis] + std::int64_t(i) * lattice.stride[axis]);
        };
        const auto [nx, ny, nz] = header().dimensions;
        const auto step = std::size_t(lattice.stride[0]);
        const bool as_it_is = std::is_same_v<Stored, Kept> && step == 1 && !voxels_.big_endian;
        const int rows = as_it_is && box.size[0] == nx && lattice.stride[1] == 1 ? box.size[1] : 1;
        std::vector<Stored> row(as_it_is ? 0 : (std::size_t(box.size[0]) - 1) * step + 1);
        for (int z = 0; z < box.size[2]; ++z)
            for (int y = 0; y < box.size[1]; y += rows) {
                const std::uint64_t line = place(2, box.first[2] + z) * std::uint64_t(ny) + place(1, box.first[1] + y);
                const std::uint64_t at = (line * std::uint64_t(nx) + place(0, box.first[0])) * sizeof(Stored);
                if (as_it_is) {
                    const std::size_t count = std::size_t(rows) * std::size_t(box.size[0]);
                    read_bytes(out, count * sizeof(Stored), at);
                    out += count;
                    continue;
                }
                read_bytes(row.data(), row.size() * sizeof(Stored), at);
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
    std::vector<SourceLevel> levels;
    std::vector<Lattice> lattices;
    for (const auto& [level, lattice] : thinned({header.dimensions, header.geometry}))
        levels.push_back(level), lattices.push_back(lattice);
    return std::make_shared<FileSource>(kept_header(header), std::move(levels), std::move(lattices), header.type,
                                        voxels, std::move(file));
}

}  // namespace chiaro
