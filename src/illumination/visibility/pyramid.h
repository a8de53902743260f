// The published pyramid of expected transparency (Ritschel 2007, section 3).
#pragma once
#include <vector>

#include "illumination/visibility/density.h"
#include "illumination/visibility/pyramid_kernel.h"
#include "illumination/visibility/walk_kernel.h"

namespace chiaro {

/// From the nodes to a single one.
std::vector<CellGrid> pyramid_grids(const CellGrid& nodes);

/// As the walk reads one.
kernel::PyramidLevel pyramid_level(const CellGrid& grid, int number, const std::uint16_t* values);

/// Level 0 is exp(-κ) of the nodes. T_{l+1} = (mean of the 8 T_l)²: two voxels one behind the other, each as open as
/// the eight are on average; missing ones are open. 65535ths.
class TransparencyPyramid {
public:
    /// Up to the level of a single node. Cost: 2.3 bytes a node. Throws Error{interrupted}.
    TransparencyPyramid(const Density& density, int threads, Progress& progress);

    const std::vector<CellValues>& levels() const { return levels_; }
    /// What the walk reads; valid while this stays where it is.
    const std::vector<kernel::PyramidLevel>& views() const { return views_; }

private:
    std::vector<CellValues> levels_;
    std::vector<kernel::PyramidLevel> views_;
};

/// The same there, made there; its work may still be under way.
class GpuPyramid {
public:
    GpuPyramid(const std::shared_ptr<cuda::Stream>& stream, const Density& density);
    const std::vector<kernel::PyramidLevel>& views() const { return views_; }

private:
    std::vector<cuda::Array<std::uint16_t>> levels_;
    std::vector<kernel::PyramidLevel> views_;
};

}  // namespace chiaro
