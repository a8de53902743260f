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
    /// Row by row, or all rows of a plane at once where little lies between them: a call costs as much as a page does.
    /// What lies between the voxels of a row is read as well.
    template <class Stored, class Kept>
    void read_as(const Lattice& lattice, const VoxelBox& box, std::byte* to) const {
        constexpr std::size_t largest_gap = 4096 / sizeof(Stored), max_span = (1 << 20) / sizeof(Stored);
        Kept* out = reinterpret_cast<Kept*>(to);
        const auto place = [&](std::size_t axis, int i) {
            return std::uint64_t(lattice.first[axis] + std::int64_t(i) * lattice.stride[axis]);
        };
        const auto [nx, ny, nz] = header().dimensions;
        const auto step = std::size_t(lattice.stride[0]), line = std::size_t(lattice.stride[1]) * std::size_t(nx);
        const std::size_t row = (std::size_t(box.size[0]) - 1) * step + 1;
        const bool as_it_is = std::is_same_v<Stored, Kept> && step == 1 && !voxels_.big_endian;
        int rows = 1;
        if (line - row <= largest_gap)
            rows = as_it_is && line == row ? box.size[1]
                                           : int(std::clamp<std::size_t>(max_span / line, 1, std::size_t(box.size[1])));
        const bool directly = as_it_is && (line == row || rows == 1);
        std::vector<Stored> read(directly ? 0 : std::size_t(rows - 1) * line + row);
        const auto place_of_row = [&](int y, int z) {
            const std::uint64_t first = place(2, box.first[2] + z) * std::uint64_t(ny) + place(1, box.first[1] + y);
            return (first * std::uint64_t(nx) + place(0, box.first[0])) * sizeof(Stored);
        };
        const bool is_scattered = rows == 1 && box.size[1] > 1 && line * sizeof(Stored) <= largest_distance;
        for (int z = 0; z < box.size[2]; ++z) {
            if (is_scattered) expect_bytes(place_of_row(0, z), place_of_row(box.size[1] - 1, z) + row * sizeof(Stored));
            for (int y = 0; y < box.size[1]; y += rows) {
                const std::uint64_t at = place_of_row(y, z);
                const auto now = std::size_t(std::min(rows, box.size[1] - y)), count = (now - 1) * line + row;
                read_bytes(directly ? static_cast<void*>(out) : read.data(), count * sizeof(Stored), at);
                if (directly) out += count;
                for (std::size_t i = 0; i < now && !directly; ++i)
                    out = put_row(read.data() + i * line, row, step, out);
            }
        }
    }

    /// Every `step`-th of them.
    template <class Stored, class Kept>
    Kept* put_row(const Stored* from, std::size_t count, std::size_t step, Kept* out) const {
        if (std::is_same_v<Stored, Kept> && step == 1 && !voxels_.big_endian) return std::copy_n(from, count, out);
        for (std::size_t i = 0; i < count; i += step) *out++ = Kept(native(from[i]));
        return out;
    }

    template <class Stored>
    Stored native(Stored stored) const {
        if (!voxels_.big_endian || sizeof(Stored) == 1) return stored;
        auto* bytes = reinterpret_cast<std::byte*>(&stored);
        std::reverse(bytes, bytes + sizeof stored);
        return stored;
    }

    /// Rows that lie so near to each other come from a disk sooner with what lies between, in one large read: of a file
    /// of 29 GB, 3072 bytes a row, a level of every fourth voxel took 8 s rather than 39.
    static constexpr std::size_t largest_distance = 32 << 10;
    void expect_bytes(std::uint64_t begin, std::uint64_t end) const {
        posix_fadvise(file_.number(), off_t(voxels_.offset + begin), off_t(end - begin), POSIX_FADV_WILLNEED);
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
