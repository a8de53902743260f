#include "illumination/visibility/pyramid.h"

#include <cmath>

#include "core/threads.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro {
namespace {

kernel::NextLevel next_kernel(const CellGrid& finer, const CellGrid& grid, const std::uint16_t* from,
                              std::uint16_t* to) {
    return {from, {finer.count[0], finer.count[1], finer.count[2]}, to, grid.count[0], grid.count[1]};
}

}  // namespace

std::vector<CellGrid> pyramid_grids(const CellGrid& nodes) {
    std::vector<CellGrid> grids{nodes};
    while (grids.back().size() > 1) grids.push_back(halved(grids.back()));
    return grids;
}

kernel::PyramidLevel pyramid_level(const CellGrid& grid, int number, const std::uint16_t* values) {
    CellGrid in_nodes = grid;
    const double edge = std::exp2(number);
    in_nodes.voxels_per_cell = {edge, edge, edge};
    return {values, view_of(in_nodes), float(1 / edge)};
}

TransparencyPyramid::TransparencyPyramid(const Density& density, int threads, Progress& progress) {
    for (const CellGrid& grid : pyramid_grids(density.grid)) levels_.emplace_back(grid);
    const auto fill = [&](CellValues& level, const auto& kernel) {
        parallel_for(threads, std::int64_t(level.grid.size()), 1 << 14, "pyramid", progress,
                     [&](std::int64_t first, std::int64_t end) {
                         for (auto node = first; node < end; ++node) kernel(node);
                     });
        progress.check();
        views_.push_back(pyramid_level(level.grid, int(views_.size()), level.data()));
    };
    fill(levels_[0], kernel::FinestLevel{density.data(), levels_[0].data()});
    for (std::size_t l = 1; l < levels_.size(); ++l)
        fill(levels_[l], next_kernel(levels_[l - 1].grid, levels_[l].grid, levels_[l - 1].data(), levels_[l].data()));
}

GpuPyramid::GpuPyramid(cuda::Stream& stream, const Density& density) {
    const std::vector<CellGrid> grids = pyramid_grids(density.grid);
    for (const CellGrid& grid : grids) {
        levels_.emplace_back(stream, grid.size() + CellValues::spare);
        levels_.back().zero();
        views_.push_back(pyramid_level(grid, int(views_.size()), levels_.back().data()));
    }
    kernel::run_on_gpu(stream, std::int64_t(grids[0].size()),
                       kernel::FinestLevel{density.on_gpu(stream), levels_[0].data()});
    for (std::size_t l = 1; l < grids.size(); ++l)
        kernel::run_on_gpu(stream, std::int64_t(grids[l].size()),
                           next_kernel(grids[l - 1], grids[l], levels_[l - 1].data(), levels_[l].data()));
}

}  // namespace chiaro
