#include "io/zarr_shard.h"

#include <blosc.h>
#include <chiaro/error.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "core/crc32c.h"
#include "core/threads.h"

namespace chiaro {
namespace {

constexpr std::uint64_t not_there = ~std::uint64_t(0);  // offset and size of a chunk that is not there
constexpr std::size_t checksum_bytes = sizeof(std::uint32_t);

/// Little endian, as this machine's numbers are; returns where the next one goes.
template <class Number>
std::byte* put_number(Number number, std::byte* to) {
    std::memcpy(to, &number, sizeof number);
    return to + sizeof number;
}

std::size_t product(const ChunkPlace& n) { return std::size_t(n[0]) * std::size_t(n[1]) * std::size_t(n[2]); }

std::size_t put_checksum(std::byte* bytes, std::size_t size) {
    put_number(crc32c({bytes, size}), bytes + size);
    return size + checksum_bytes;
}

/// With what zstd needs for its work, once a thread.
std::size_t zstd_packed(const std::vector<std::byte>& raw, std::byte* to, std::size_t most) {
    struct Free {
        void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
    };
    thread_local const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
    const std::size_t bytes =
        context ? ZSTD_compressCCtx(context.get(), to, most, raw.data(), raw.size(), ShardEncoder::zstd_level) : 0;
    if (!context || ZSTD_isError(bytes)) throw Error(ErrorCode::internal, "a chunk cannot be packed");
    return bytes;
}

std::size_t blosc_packed(const std::vector<std::byte>& raw, std::size_t voxel_bytes, std::byte* to, std::size_t most) {
    constexpr int threads = 1;
    const int bytes = blosc_compress_ctx(ShardEncoder::blosc_level, int(ShardEncoder::shuffle_of(voxel_bytes)),
                                         voxel_bytes, raw.size(), raw.data(), to, most, ShardEncoder::blosc_compressor,
                                         ShardEncoder::blosc_block, threads);
    if (bytes <= 0) throw Error(ErrorCode::internal, "a chunk cannot be packed");
    return std::size_t(bytes);
}

}  // namespace

ShardEncoder::ShardEncoder(VoxelType type, ZarrEncoding encoding, const ChunkPlace& shard)
    : voxel_bytes_(size_of(type)),
      encoding_(encoding),
      raw_bytes_(voxel_bytes_ * zarr_chunk_edge * zarr_chunk_edge * zarr_chunk_edge) {
    for (std::size_t axis = 0; axis < 3; ++axis) chunks_[axis] = shard[axis] / zarr_chunk_edge;
    max_chunk_bytes_ = encoding == ZarrEncoding::raw    ? raw_bytes_
                       : encoding == ZarrEncoding::zstd ? ZSTD_compressBound(raw_bytes_)
                                                        : raw_bytes_ + BLOSC_MAX_OVERHEAD;
}

std::size_t ShardEncoder::max_bytes() const {
    return product(chunks_) * (max_chunk_bytes_ + checksum_bytes + 2 * sizeof(std::uint64_t)) + checksum_bytes;
}

std::size_t ShardEncoder::encode(const Block& block, std::byte* to) const {
    ChunkPlace there{};
    for (std::size_t axis = 0; axis < 3; ++axis) there[axis] = (block.box.size[axis] - 1) / zarr_chunk_edge + 1;
    const std::size_t slot = max_chunk_bytes_ + checksum_bytes;
    std::vector<std::size_t> sizes(product(there));
    parallel_for(usable_threads(), std::int64_t(sizes.size()), 1, [&](std::int64_t i, std::int64_t) {
        const ChunkPlace at{int(i) % there[0], int(i) / there[0] % there[1], int(i) / there[0] / there[1]};
        sizes[std::size_t(i)] = encode_chunk(block, at, to + std::size_t(i) * slot);
    });
    std::vector<std::byte> index(product(chunks_) * 2 * sizeof(std::uint64_t) + checksum_bytes);
    std::byte* entry = index.data();
    std::size_t offset = 0, number = 0;
    for (int z = 0; z < chunks_[2]; ++z)
        for (int y = 0; y < chunks_[1]; ++y)
            for (int x = 0; x < chunks_[0]; ++x) {
                const bool is_inside = x < there[0] && y < there[1] && z < there[2];
                const std::size_t bytes = is_inside ? sizes[number] : 0;
                entry = put_number<std::uint64_t>(is_inside ? offset : not_there, entry);
                entry = put_number<std::uint64_t>(is_inside ? bytes : not_there, entry);
                if (is_inside) std::memmove(to + offset, to + number++ * slot, bytes);
                offset += bytes;
            }
    put_checksum(index.data(), index.size() - checksum_bytes);
    std::ranges::copy(index, to + offset);
    return offset + index.size();
}

std::size_t ShardEncoder::encode_chunk(const Block& block, const ChunkPlace& at, std::byte* to) const {
    if (encoding_ == ZarrEncoding::raw) {
        gather(block, at, to);
        return put_checksum(to, raw_bytes_);
    }
    thread_local std::vector<std::byte> raw;
    raw.resize(raw_bytes_);
    gather(block, at, raw.data());
    return put_checksum(to, encoding_ == ZarrEncoding::zstd ? zstd_packed(raw, to, max_chunk_bytes_)
                                                            : blosc_packed(raw, voxel_bytes_, to, max_chunk_bytes_));
}

/// Zeros where the chunk reaches over the border.
void ShardEncoder::gather(const Block& block, const ChunkPlace& at, std::byte* to) const {
    const std::size_t row = zarr_chunk_edge * voxel_bytes_;
    ChunkPlace size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = std::min(zarr_chunk_edge, block.box.size[axis] - at[axis] * zarr_chunk_edge);
    if (size != ChunkPlace{zarr_chunk_edge, zarr_chunk_edge, zarr_chunk_edge}) std::memset(to, 0, raw_bytes_);
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y) {
            const std::size_t line = std::size_t(at[2] * zarr_chunk_edge + z) * std::size_t(block.box.size[1]) +
                                     std::size_t(at[1] * zarr_chunk_edge + y);
            const std::size_t from = line * std::size_t(block.box.size[0]) + std::size_t(at[0] * zarr_chunk_edge);
            std::memcpy(to + std::size_t(z * zarr_chunk_edge + y) * row, block.voxels.data() + from * voxel_bytes_,
                        std::size_t(size[0]) * voxel_bytes_);
        }
}

}  // namespace chiaro
