#include "illumination/visibility/pyramid.h"

#include <cmath>

#include "core/threads.h"

namespace chiaro {
namespace {

template <class FillRow>
void for_each_row(const CellGrid& grid, int threads, Progress& progress, const FillRow& fill) {
    const auto [nx, ny, nz] = grid.count;
    parallel_for(threads, std::int64_t(ny) * nz, 64, "pyramid", progress,
                 [&, ny = ny](std::int64_t first, std::int64_t end) {
                     for (auto row = first; row < end; ++row) fill(int(row % ny), int(row / ny));
                 });
    progress.check();
}

CellValues finest(const Density& density, int threads, Progress& progress) {
    CellValues level(density.grid);
    for_each_row(density.grid, threads, progress, [&](int y, int z) {
        const std::size_t row = density.grid.index(0, y, z);
        for (int x = 0; x < density.grid.count[0]; ++x)
            level.data()[row + x] = cell_value(std::exp(-double(density.data()[row + x])));
    });
    return level;
}

CellValues next_level(const CellValues& finer, int threads, Progress& progress) {
    CellValues level(halved(finer.grid));
    const auto [nx, ny, nz] = finer.grid.count;
    const auto child = [&, nx = nx, ny = ny, nz = nz](int x, int y, int z) {
        return x < nx && y < ny && z < nz ? int(finer.data()[finer.grid.index(x, y, z)]) : int(cell_one);
    };
    for_each_row(level.grid, threads, progress, [&](int y, int z) {
        std::uint16_t* row = level.data() + level.grid.index(0, y, z);
        for (int x = 0; x < level.grid.count[0]; ++x) {
            int sum = 0;
            for (int i = 0; i < 8; ++i) sum += child(2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2));
            const double mean = sum / (8.0 * cell_one);
            row[x] = cell_value(mean * mean);
        }
    });
    return level;
}

kernel::PyramidLevel view_of(const CellValues& level, int number) {
    CellGrid in_nodes = level.grid;
    const double edge = std::exp2(number);
    in_nodes.voxels_per_cell = {edge, edge, edge};
    return {level.data(), view_of(in_nodes), float(1 / edge)};
}

}  // namespace

TransparencyPyramid::TransparencyPyramid(const Density& density, int threads, Progress& progress) {
    levels_.push_back(finest(density, threads, progress));
    while (levels_.back().grid.size() > 1) levels_.push_back(next_level(levels_.back(), threads, progress));
    for (const CellValues& level : levels_) views_.push_back(view_of(level, int(views_.size())));
}

}  // namespace chiaro
