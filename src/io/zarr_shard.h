// The bytes of one file of a Zarr store: chunks, one behind the other, and where each begins.
#pragma once
#include "io/zarr_pyramid.h"

namespace chiaro {

class ShardEncoder {
public:
    /// `shard`: voxels of a whole one, of full chunks, per axis.
    ShardEncoder(VoxelType type, ZarrEncoding encoding, const std::array<int, 3>& shard);

    std::size_t max_bytes() const;  ///< of any shard's file, and of what is needed while it is made
    /// Makes the file of the shard that the block is, or begins, on all threads, at the address of max_bytes() bytes;
    /// returns its size.
    std::size_t encode(const Block& block, std::byte* to) const;

    static constexpr int zstd_level = 1;
    // Of a head's CT of 16 bits this packs as well as zstd does (.30), in two fifths of its time; shuffled by bytes
    // .32. Floats are shuffled by bytes (an MRI's .23, by bits .30). Level 9 looks for more: .30 where 5 leaves .31.
    static constexpr const char* blosc_compressor = "lz4";
    static constexpr int blosc_level = 9, blosc_block = 0;  // 0: as blosc thinks best
    enum class Shuffle { bytes = 1, bits = 2 };
    static constexpr Shuffle shuffle_of(std::size_t voxel_bytes) {
        return voxel_bytes <= 2 ? Shuffle::bits : Shuffle::bytes;
    }

private:
    std::size_t encode_chunk(const Block& block, const ChunkPlace& at, std::byte* to) const;
    void gather(const Block& block, const ChunkPlace& at, std::byte* to) const;

    const std::size_t voxel_bytes_;
    const ZarrEncoding encoding_;
    ChunkPlace chunks_{};
    std::size_t raw_bytes_, max_chunk_bytes_;  ///< of a chunk; without its checksum
};

}  // namespace chiaro
