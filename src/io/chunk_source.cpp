#include "io/chunk_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>

#include "io/chunk_cache.h"
#include "io/lattice.h"

namespace chiaro {
namespace {

constexpr std::size_t cache_bytes = std::size_t(256) << 20;

/// A level of the source: one of the file's, or some voxels of one.
struct Stored {
    int level = 0;
    Lattice lattice;
};

/// Along one axis, what of a box lies in a chunk: voxels of the box, and where in the chunk the first of them is.
struct Share {
    int first = 0, end = 0, in_chunk = 0;
};

Share share_of(int first, int size, int lattice_first, int stride, std::int64_t chunk_begin, std::int64_t chunk_end) {
    const auto voxel = [&](std::int64_t i) { return lattice_first + (first + i) * stride; };
    const auto reaches = [&](std::int64_t at) {  // the first of the box that lies at `at` or behind it
        const std::int64_t before = at - voxel(0);
        return int(std::clamp<std::int64_t>(before <= 0 ? 0 : (before - 1) / stride + 1, 0, size));
    };
    Share share{reaches(chunk_begin), reaches(chunk_end), 0};
    share.in_chunk = int(voxel(share.first) - chunk_begin);
    return share;
}

class ChunkSource final : public BrickSource {
public:
    ChunkSource(Volume header, std::unique_ptr<ChunkReader> reader, std::vector<SourceLevel> levels,
                std::vector<Stored> stored)
        : BrickSource(std::move(header), std::move(levels)),
          reader_(std::move(reader)),
          stored_(std::move(stored)),
          cache_(cache_bytes),
          unwritten_(reader_->levels().size()) {}

    void read(int level, const VoxelBox& box, std::byte* to) const override {
        const auto& [file_level, lattice] = stored_[std::size_t(level)];
        const ChunkedLevel& grid = reader_->levels()[std::size_t(file_level)];
        std::array<int, 3> begin{}, end{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int64_t first = lattice.first[axis] + std::int64_t(box.first[axis]) * lattice.stride[axis];
            begin[axis] = int(first / grid.chunk[axis]);
            end[axis] = int((first + std::int64_t(box.size[axis] - 1) * lattice.stride[axis]) / grid.chunk[axis]) + 1;
        }
        for (int z = begin[2]; z < end[2]; ++z)
            for (int y = begin[1]; y < end[1]; ++y)
                for (int x = begin[0]; x < end[0]; ++x) copy_share(file_level, lattice, {x, y, z}, box, to);
    }

    std::array<int, 3> piece(int level) const override {
        constexpr int least = 32;
        const auto& [file_level, lattice] = stored_[std::size_t(level)];
        const ChunkedLevel& grid = reader_->levels()[std::size_t(file_level)];
        std::array<int, 3> size{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int a_chunk = std::max(1, grid.chunk[axis] / lattice.stride[axis]);
            size[axis] = std::min(a_chunk * ((least - 1) / a_chunk + 1), levels()[std::size_t(level)].dimensions[axis]);
        }
        return size;
    }

    std::size_t keep_decoded(std::size_t max_bytes) const override {
        const std::size_t bytes = std::min(max_bytes, cache_bytes);
        cache_.keep_at_most(bytes);
        return bytes;
    }

    bool is_far() const override { return reader_->is_far(); }

private:
    void copy_share(int file_level, const Lattice& lattice, const std::array<int, 3>& chunk, const VoxelBox& box,
                    std::byte* to) const {
        const ChunkedLevel& grid = reader_->levels()[std::size_t(file_level)];
        std::array<Share, 3> shares;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int64_t begin = std::int64_t(chunk[axis]) * grid.chunk[axis];
            shares[axis] = share_of(box.first[axis], box.size[axis], lattice.first[axis], lattice.stride[axis], begin,
                                    begin + grid.chunk[axis]);
            if (shares[axis].first >= shares[axis].end) return;
        }
        const ChunkCache::Chunk voxels =
            cache_.get(key_of(file_level, chunk), [&] { return decoded(file_level, chunk); });
        const auto& [sx, sy, sz] = shares;
        const auto [step_x, step_y, step_z] = lattice.stride;
        with_voxel_type(header().type, [&](auto zero) {
            using T = decltype(zero);
            const T* from = reinterpret_cast<const T*>(voxels->data());
            T* out = reinterpret_cast<T*>(to);
            for (int z = sz.first; z < sz.end; ++z)
                for (int y = sy.first; y < sy.end; ++y) {
                    const std::size_t in_z = std::size_t(sz.in_chunk + (z - sz.first) * step_z),
                                      in_y = std::size_t(sy.in_chunk + (y - sy.first) * step_y);
                    const T* row = from + (in_z * std::size_t(grid.chunk[1]) + in_y) * std::size_t(grid.chunk[0]) +
                                   std::size_t(sx.in_chunk);
                    T* line =
                        out + (std::size_t(z) * std::size_t(box.size[1]) + std::size_t(y)) * std::size_t(box.size[0]);
                    for (int x = sx.first; x < sx.end; ++x, row += step_x) line[x] = *row;
                }
        });
    }

    std::uint64_t key_of(int file_level, const std::array<int, 3>& chunk) const {
        std::uint64_t key = std::uint64_t(file_level);
        for (const int at : chunk) key = key << 16 | std::uint64_t(at);  // there are at most 65535 along an axis
        return key;
    }

    /// With numbers as the source has them. All that were never written are the same one: much of what is sparse.
    ChunkCache::Chunk decoded(int file_level, const std::array<int, 3>& chunk) const {
        ChunkCache::Chunk kept;
        reader_->decode(file_level, chunk, [&](std::span<const std::byte> voxels, bool was_written) {
            if (was_written) {
                kept = copied(voxels);
                return;
            }
            const std::lock_guard lock(unwritten_mutex_);
            ChunkCache::Chunk& unwritten = unwritten_[std::size_t(file_level)];
            if (!unwritten) unwritten = copied(voxels);
            kept = unwritten;
        });
        return kept;
    }

    ChunkCache::Chunk copied(std::span<const std::byte> voxels) const {
        const std::size_t count = voxels.size() / size_of(reader_->header().type);
        VoxelBuffer kept(count * size_of(header().type));
        if (reader_->header().type == header().type)
            std::memcpy(kept.data(), voxels.data(), kept.size());
        else
            with_voxel_type(reader_->header().type, [&](auto zero) {
                const auto* from = reinterpret_cast<const decltype(zero)*>(voxels.data());
                std::transform(from, from + count, reinterpret_cast<float*>(kept.data()),
                               [](auto v) { return float(v); });
            });
        return std::make_shared<const VoxelBuffer>(std::move(kept));
    }

    std::unique_ptr<ChunkReader> reader_;
    std::vector<Stored> stored_;
    mutable ChunkCache cache_;
    mutable std::mutex unwritten_mutex_;
    mutable std::vector<ChunkCache::Chunk> unwritten_;  ///< of each of the file's levels
};

std::shared_ptr<const BrickSource> source_of_reader(std::unique_ptr<ChunkReader> reader,
                                                    const std::function<void(Volume&)>& finish) {
    std::vector<SourceLevel> levels;
    std::vector<Stored> stored;
    for (const ChunkedLevel& level : reader->levels()) {
        const int longest = *std::max_element(level.dimensions.begin(), level.dimensions.end());
        if (!levels.empty() && longest < least_level_edge) break;
        stored.push_back({int(levels.size()), {}});
        levels.push_back({level.dimensions, level.geometry});
    }
    const int coarsest = int(levels.size()) - 1;
    const auto coarser = thinned(levels.back());
    for (std::size_t i = 1; i < coarser.size(); ++i) {
        levels.push_back(coarser[i].level);
        stored.push_back({coarsest, coarser[i].lattice});
    }
    Volume header = kept_header(reader->header());
    if (const int components = reader->header().components; components > 1)
        header.notes.push_back(fmt::format("by bricks the first of {} values a voxel is shown", components));
    if (finish) finish(header);
    return std::make_shared<ChunkSource>(std::move(header), std::move(reader), std::move(levels), std::move(stored));
}

}  // namespace

ChunkReader::~ChunkReader() = default;

std::shared_ptr<const BrickSource> source_of_chunks(std::unique_ptr<ChunkReader> reader) {
    return source_of_reader(std::move(reader), {});
}

std::shared_ptr<const BrickSource> open_chunk_source(const DecodeRequest& request, const ReadOptions& options,
                                                     const std::function<void(Volume&)>& finish) {
    return source_of_reader(std::make_unique<ChunkServer>(request, options), finish);
}

}  // namespace chiaro
