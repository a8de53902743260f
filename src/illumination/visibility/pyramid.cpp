#include "illumination/visibility/pyramid.h"

#include <cmath>

#include "cuda/executor.h"

namespace chiaro {
namespace {

kernel::NextLevel next_kernel(const CellGrid& finer, const CellGrid& grid, const std::uint16_t* from,
                              std::uint16_t* to) {
    return {from, {finer.count[0], finer.count[1], finer.count[2]}, to, grid.count[0], grid.count[1]};
}

/// From the finest level on; `levels` in the executor's memory.
template <class Executor>
void fill_levels(const Executor& executor, const Density& density, const std::vector<CellGrid>& grids,
                 const std::vector<std::uint16_t*>& levels) {
    constexpr std::int64_t grain = 1 << 14;
    executor.for_each(std::int64_t(grids[0].size()), kernel::FinestLevel{executor.values(density), levels[0]},
                      "pyramid", grain);
    for (std::size_t l = 1; l < grids.size(); ++l)
        executor.for_each(std::int64_t(grids[l].size()), next_kernel(grids[l - 1], grids[l], levels[l - 1], levels[l]),
                          "pyramid", grain);
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
    const std::vector<CellGrid> grids = pyramid_grids(density.grid);
    std::vector<std::uint16_t*> levels;
    for (const CellGrid& grid : grids) levels_.emplace_back(grid), levels.push_back(levels_.back().data());
    fill_levels(CpuExecutor(threads, &progress), density, grids, levels);
    for (const CellValues& level : levels_)
        views_.push_back(pyramid_level(level.grid, int(views_.size()), std::as_const(level).data()));
}

GpuPyramid::GpuPyramid(const std::shared_ptr<cuda::Stream>& stream, const Density& density) {
    const GpuExecutor executor(stream);
    const std::vector<CellGrid> grids = pyramid_grids(density.grid);
    std::vector<std::uint16_t*> levels;
    for (const CellGrid& grid : grids) {
        levels_.push_back(executor.zeros<std::uint16_t>(grid.size() + CellValues::spare));
        levels.push_back(levels_.back().data());
        views_.push_back(pyramid_level(grid, int(views_.size()), levels.back()));
    }
    fill_levels(executor, density, grids, levels);
}

}  // namespace chiaro
