// Volumes of any size: voxels that are read where they are needed.
#pragma once
#include <chiaro/export.h>
#include <chiaro/progress.h>
#include <chiaro/volume.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace chiaro {

/// One resolution of a volume: a grid of its own, in the same world.
struct SourceLevel {
    std::array<int, 3> dimensions{0, 0, 0};
    Geometry geometry;
};

/// No level's longest axis is shorter, but where the volume's own is.
inline constexpr int least_level_edge = 32;

/// The grid whose voxel (0, 0, 0) is `first` of another, and the next ones `stride` away from it.
inline Geometry every(const Geometry& geometry, Vec3 stride, Vec3 first) {
    Geometry coarser = geometry;
    coarser.origin_mm = geometry.world_from_voxel(first);
    for (int axis = 0; axis < 3; ++axis) coarser.spacing_mm[axis] *= stride[axis];
    return coarser;
}

struct VoxelBox {
    std::array<int, 3> first{0, 0, 0}, size{0, 0, 0};
};

/// The one door for voxels of a volume that need not fit in memory. Level 0 is the volume itself; those behind it are
/// coarser. Never changes; may be read from several threads at a time.
class CHIARO_EXPORT BrickSource {
public:
    virtual ~BrickSource();
    BrickSource(const BrickSource&) = delete;
    BrickSource& operator=(const BrickSource&) = delete;

    /// All that is known of level 0 but its voxels. The type is u8, i8, u16, i16 or f32.
    const Volume& header() const { return header_; }
    const std::vector<SourceLevel>& levels() const { return levels_; }  ///< finest first
    /// The voxels of a box within a level, of the header's type, x fastest. Throws Error{input} where they cannot be
    /// had.
    virtual void read(int level, const VoxelBox& box, std::byte* to) const = 0;
    /// What of a level is read at the least cost: boxes of this size, side by side from voxel (0, 0, 0) on. Slices,
    /// where a source knows no better.
    virtual std::array<int, 3> piece(int level) const;
    /// Has it keep no more than so many bytes of what it decoded last, from now on; returns how many it may take. None,
    /// where a source keeps nothing.
    virtual std::size_t keep_decoded(std::size_t max_bytes) const;
    /// Whether voxels come over a network, so that few are to be read before there is a picture.
    virtual bool is_far() const;

protected:
    BrickSource(Volume header, std::vector<SourceLevel> levels);

private:
    Volume header_;
    std::vector<SourceLevel> levels_;
};

/// A level that is kept in chunks, side by side from voxel (0, 0, 0) on.
struct ChunkedLevel {
    std::array<int, 3> dimensions{0, 0, 0}, chunk{1, 1, 1};  ///< x, y, z; chunks reach beyond the far border
    Geometry geometry;

    std::uint64_t chunk_voxels() const { return std::uint64_t(chunk[0]) * std::uint64_t(chunk[1]) * chunk[2]; }
    std::array<int, 3> chunks() const {
        std::array<int, 3> count{};
        for (std::size_t axis = 0; axis < 3; ++axis) count[axis] = (dimensions[axis] - 1) / chunk[axis] + 1;
        return count;
    }
};

/// Who decodes the chunks of a volume. A program with a storage of its own derives from this.
class CHIARO_EXPORT ChunkReader {
public:
    virtual ~ChunkReader();
    virtual const Volume& header() const = 0;                     ///< of level 0; of any type
    virtual const std::vector<ChunkedLevel>& levels() const = 0;  ///< finest first
    virtual bool is_far() const { return false; }                 ///< as BrickSource::is_far
    /// Of a chunk that was never written all voxels hold one value, the same in all such chunks of a level.
    using Use = std::function<void(std::span<const std::byte> voxels, bool was_written)>;
    /// Calls `use` with the chunk's voxels, x fastest, of the header's type; of those beyond the far border with
    /// anything. May be called from several threads at a time. Throws Error{input} where it cannot be decoded.
    virtual void decode(int level, const std::array<int, 3>& chunk, const Use& use) = 0;
};
/// The reader's levels, and coarser ones of every second voxel of its coarsest and so on. Chunks that were decoded last
/// are kept, up to 256 MiB; each is decoded once however many threads ask for it, one that cannot be is not tried
/// again.
CHIARO_EXPORT std::shared_ptr<const BrickSource> source_of_chunks(std::unique_ptr<ChunkReader> reader);

/// The finest level of at most so many voxels along its longest axis, or the coarsest: 256 are read in no time.
CHIARO_EXPORT int small_level(const BrickSource& source, int edge = 256);

/// A level as a volume in memory. Throws Error{interrupted} when cancelled, and as `read`. Reported as "read".
CHIARO_EXPORT Volume read_level(const BrickSource& source, int level, Progress& progress);

/// Bytes that pictures of a volume as a whole take, light included, to within a half: what a budget is held against.
CHIARO_EXPORT double whole_volume_bytes(const std::array<int, 3>& dimensions, VoxelType type);

}  // namespace chiaro
