// What rays are stopped by, unrounded: extinction per cell edge, of every cell or over the stored values.
#pragma once
#include <chiaro/progress.h>

#include "classify/medium.h"
#include "illumination/cells/opacity.h"
#include "illumination/reference/extinction_kernel.h"
#include "illumination/visibility/density.h"
#include "volume/device_view.h"

namespace chiaro {

/// Extinction per edge of entry j: the stored value (j - index_offset) / index_scale.
struct ExtinctionTable {
    std::vector<float> per_edge;
    float index_scale = 1, index_offset = 0;
};

/// The optical table's; of isosurfaces, what one edge inside stops.
ExtinctionTable extinction_table(const Medium::Data& medium, const CellGrid& grid);

/// Extinction of every cell, in rows with gaps, so that sixteen rays in lock step can be read where some have left the
/// grid. Cells `stride` apart along x are neighbours in memory: those are the ones that march together. What a GPU
/// made stays there until the host reads it.
class ExtinctionCells {
public:
    /// Cost: one look-up a cell near matter. Throws Error{output} for too many cells, Error{interrupted}.
    ExtinctionCells(const Medium::Data& medium, const CellOpacity& opacity, int stride, const Device& device,
                    Progress& progress);
    /// Of nodes: the edge is the node's.
    ExtinctionCells(const Density& density, int stride, const Device& device, Progress& progress);

    /// Where they are once they have come: before the host reads any, what `add_to` tells of is fetched.
    const float* address() const { return reinterpret_cast<const float*>(buffer_.address()) + gap; }
    void add_to(HostArrays& arrays) const { arrays.add(buffer_.array()); }
    int row() const { return layout_.row; }
    int slice() const { return layout_.slice; }
    /// Rounded up to whole strides.
    const std::array<int, 3>& count() const { return count_; }
    /// Where a cell lies in its row; x may be outside.
    int place(int x) const { return layout_.place(x); }
    /// First and last cell along an axis that stop any light; low > high: none does.
    int low(int axis) const { return held_.low[axis]; }
    int high(int axis) const { return held_.high[axis]; }

private:
    static constexpr int gap = 16;
    struct Range {
        std::array<int, 3> low{0, 0, 0}, high{-1, -1, -1};
        void add(int x, int y, int z, kernel::RowSpan span);
        void add(const Range& other);
    };

    ExtinctionCells(const CellGrid& grid, int stride);
    /// extinction(x, y, z) of the cells of the blocks that are held; `arrays`: what it reads.
    template <class Extinction>
    void fill(const CellGrid& grid, const BlockMap& blocks, const Extinction& extinction, const HostArrays& arrays,
              const Device& device, Progress& progress);
    template <class Extinction>
    void fill_here(const kernel::ExtinctionRow<Extinction>& row, const CellGrid& grid, const BlockMap& blocks,
                   const Device& device, Progress& progress);
    template <class Extinction>
    void fill_there(kernel::ExtinctionRow<Extinction> row, const BlockMap& blocks, const HostArrays& arrays,
                    const Device& device, Progress& progress);

    std::array<int, 3> count_;
    kernel::ExtinctionLayout layout_{};
    Range held_;
    MirroredBuffer buffer_{0};
};

}  // namespace chiaro
