// What stands behind a DeviceVolume.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/medium.h>

#include <memory>
#include <mutex>
#include <vector>

#include "core/host_array.h"
#include "volume/bricks.h"

namespace chiaro {

/// Smallest and largest stored value in each 4³ cell, its shared border included.
struct CellRanges {
    std::array<int, 3> count{0, 0, 0};
    std::vector<float> low, high;  ///< x fastest
};

/// What a spline's coefficients stand for: stored = (coefficient - base) * scale + least.
struct SplineCoding {
    float base = 0, scale = 1, least = 0;
};

/// Coefficients of a spline that are kept between two stored values, so that it is wherever all around it are.
struct CoefficientBounds {
    std::vector<std::uint8_t> is_bounded;  ///< 1 for each voxel whose own is, x fastest
    float low, high;
};

/// What opacity by gradient leaves of the extinction: [row][column], a row for each magnitude of the gradient in data
/// units per mm, a column for each stored value (one: for all).
struct ExtinctionFactor {
    std::vector<float> entries;
    int columns = 1, rows = 1;
    double index_scale = 0, index_offset = 0;  ///< column of a stored value
    double rows_per_unit = 0;                  ///< row = magnitude * rows_per_unit
    std::vector<std::array<float, 3>> colors;  ///< of each entry, as composited; empty: they are those of the values
};
struct LabelBricks;  // volume/label_bricks.h
/// Channels on one grid, as kernels read them: `count` kernel::ChannelView of the stored type, with all they point to.
struct MixtureOfChannels {
    std::shared_ptr<const void> channel_views;
    int count = 0;
    std::shared_ptr<const LabelBricks> labels;  ///< that lie in them; null: none
    bool own_colors = false;                    ///< the first channel has extinction, the others say its colour
};
struct LevelPages;  // volume/paged_level.h

/// The splines that were made of a volume (volume/splined.h).
struct DeviceVolume::Splines {
    std::mutex mutex;
    std::shared_ptr<const Data> interpolating, smoothing;
};

struct DeviceVolume::Data : std::enable_shared_from_this<Data> {
    Device device;
    std::array<int, 3> dimensions{0, 0, 0};
    Geometry geometry;
    VoxelType stored = VoxelType::u8;  ///< u8, u16 or f32
    VoxelBuffer bricks;
    double scale = 1, offset = 0;     ///< value = scale * stored + offset
    double shift = 0, intercept = 0;  ///< the same to the last bit: scale * (stored + shift) + intercept
    bool exact = true;                ///< no voxel was rounded or replaced when it was stored
    bool whole_numbers = false;       ///< the stored values are integers
    CellRanges cells;                 ///< of all values, those between voxels too
    float stored_min = 0, stored_max = 0;

    /// All that another volume says of its grid and of what its numbers mean; not the voxels.
    void describe_as(const Data& other) {
        device = other.device, dimensions = other.dimensions, geometry = other.geometry, stored = other.stored;
        scale = other.scale, offset = other.offset, shift = other.shift, intercept = other.intercept;
        exact = other.exact, whole_numbers = other.whole_numbers;
        placement = other.placement, held = other.held;
    }
    /// The file's own value of a stored number.
    double value_of(double number) const { return scale * (number + shift) + intercept; }

    VoxelBuffer coefficients;  ///< of a spline, laid out as the bricks; empty: values are linear between voxels
    SplineCoding spline;
    std::shared_ptr<const CoefficientBounds> bounds;  ///< of the spline that interpolates it; null: none
    std::array<float, 3> normal_reach{0, 0, 0};       ///< kernel::SplineView::reach
    const Data* source = nullptr;  ///< of a spline: the volume whose bricks it borrows, and which outlives it
    mutable Splines splines;
    DeviceVolume plain;  ///< of a medium's with a factor or a mixture: what it borrows all from
    std::shared_ptr<const ExtinctionFactor> factor;
    std::shared_ptr<const MixtureOfChannels> mixture;  ///< what is seen in the place of the voxels
    std::optional<Placement> placement;                ///< of a block: the bricks and cells beyond it were never filled
    VoxelBox held;                                     ///< what the block holds, ghosts included
    std::shared_ptr<const LevelPages> pages;           ///< of a level by bricks: which of them are there; null: all are

    void add_to(HostArrays& arrays) const {
        if (plain) plain.data().add_to(arrays);
        if (factor) arrays.add(factor, factor->entries);
        if (plain) return;
        const auto keeper = [&](const VoxelBuffer& buffer) {
            return buffer.is_borrowed() && source ? source->weak_from_this() : weak_from_this();
        };
        arrays.add(keeper(bricks), bricks);
        arrays.add(keeper(coefficients), coefficients);
        arrays.add(weak_from_this(), cells.low);
        arrays.add(weak_from_this(), cells.high);
    }
};

/// Whether a volume is another one, or the same voxels looked at in another way.
inline bool is_look_at(const DeviceVolume::Data& volume, const DeviceVolume::Data& voxels) {
    if (&volume == &voxels) return true;
    if (volume.plain) return is_look_at(volume.plain.data(), voxels);
    return volume.source && is_look_at(*volume.source, voxels);
}

/// Slices of a layer of bricks that are read: behind the volume, what the ranges of its last cells touch.
inline int slices_read(int slices, int layer) {
    return std::min(brick_row, brick_before + slices + cell_edge - layer * brick_edge);
}

/// Where voxel (x, y, z) lies in the bricks.
inline std::size_t voxel_index(const DeviceVolume::Data& volume, int x, int y, int z) {
    // The last voxel of an axis is the border of the last brick.
    const auto brick = [](int i, int n) { return std::min(i / brick_edge, brick_count(n) - 1); };
    const auto& n = volume.dimensions;
    const std::array<int, 3> b{brick(x, n[0]), brick(y, n[1]), brick(z, n[2])};
    const std::size_t index = (std::size_t(b[2]) * brick_count(n[1]) + b[1]) * brick_count(n[0]) + b[0];
    const int local =
        ((z - b[2] * brick_edge + brick_before) * brick_row + y - b[1] * brick_edge + brick_before) * brick_row + x -
        b[0] * brick_edge + brick_before;
    return index * brick_voxels + std::size_t(local);
}

}  // namespace chiaro
