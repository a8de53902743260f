// What rays are stopped by, unrounded: extinction per cell edge, of every cell or over the stored values.
#pragma once
#include <chiaro/progress.h>

#include "classify/medium.h"
#include "illumination/cells/opacity.h"
#include "illumination/visibility/density.h"
#include "volume/device_view.h"

namespace chiaro {

/// Extinction per edge of entry j: the stored value (j - index_offset) / index_scale.
struct ExtinctionTable {
    std::vector<float> per_edge;
    float index_scale = 1, index_offset = 0;

    float operator()(float stored) const {
        const float index = stored * index_scale + index_offset + 0.5f;
        return per_edge[std::size_t(std::clamp(index, 0.0f, float(per_edge.size() - 1)))];
    }
};

/// The optical table's; of isosurfaces, what one edge inside stops.
ExtinctionTable extinction_table(const Medium::Data& medium, const CellGrid& grid);

/// Extinction of every cell, in rows with gaps, so that sixteen rays in lock step can be read where some have left the
/// grid. Cells `stride` apart along x are neighbours in memory: those are the ones that march together.
class ExtinctionCells {
public:
    /// Cost: one look-up a cell near matter. Throws Error{output} for too many cells, Error{interrupted}.
    ExtinctionCells(const Medium::Data& medium, const CellOpacity& opacity, int stride, Progress& progress);
    /// Of nodes: the edge is the node's.
    ExtinctionCells(const Density& density, int stride, const Device& device, Progress& progress);

    const float* data() const { return reinterpret_cast<const float*>(buffer_.data()) + gap; }
    void add_to(HostArrays& arrays) const { arrays.add(buffer_); }
    int row() const { return row_; }
    int slice() const { return slice_; }
    /// Rounded up to whole strides.
    const std::array<int, 3>& count() const { return count_; }
    /// Where a cell lies in its row; x may be outside.
    int place(int x) const {
        const int turn = x >= 0 ? x / stride_ : -((stride_ - 1 - x) / stride_);
        return (x - turn * stride_) * phase_ + turn;
    }
    /// First and last cell along an axis that stop any light; low > high: none does.
    int low(int axis) const { return low_[axis]; }
    int high(int axis) const { return high_[axis]; }

private:
    static constexpr int gap = 16;
    ExtinctionCells(const CellGrid& grid, int stride);
    /// extinction(x, y, z) of the cells of the blocks that are held.
    template <class Extinction>
    void fill(const CellGrid& grid, const BlockMap& blocks, int threads, const Extinction& extinction,
              Progress& progress);

    std::array<int, 3> count_, low_{0, 0, 0}, high_{-1, -1, -1};
    int stride_, phase_, row_ = 0, slice_ = 0;
    VoxelBuffer buffer_;
};

}  // namespace chiaro
