// Between which values a spline lies in each cell.
#pragma once
#include <limits>
#include <tuple>

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"

namespace chiaro {

/// Between which codes the spline lies in a cell: those of coefficients for knots half as far apart (Lane and
/// Riesenfeld 1980), which bound it about twice as tightly. `corner` is the first of its 7³, `depth` of whose slices
/// are there.
template <class Voxel>
std::pair<float, float> refined_range(const Voxel* corner, int depth) {
    constexpr int n = cell_edge + 3, fine = 2 * n - 3, row = 12;  // a multiple of what vectors hold
    using Row = std::array<float, row>;
    const auto refine = [](const auto& from, int stride, int i, const auto& put) {
        const int k = i / 2 * stride;
        if (i % 2 == 0)
            for (int j = 0; j < row; ++j) put(j, 0.5f * (from[k][j] + from[k + stride][j]));
        else
            for (int j = 0; j < row; ++j)
                put(j, 0.125f * (from[k][j] + from[k + 2 * stride][j]) + 0.75f * from[k + stride][j]);
    };
    std::array<Row, n * fine> planes;  // refined along x, then y
    for (int z = 0; z < n; ++z) {
        std::array<Row, n> rows;
        for (int y = 0; y < n; ++y) {
            const Voxel* c = corner + std::min(z, depth - 1) * brick_slice + y * brick_row;
            for (int i = 0; i < row; ++i) {
                const int k = std::min(i, fine - 1) / 2;
                rows[std::size_t(y)][std::size_t(i)] =
                    std::min(i, fine - 1) % 2 == 0 ? 0.5f * (float(c[k]) + float(c[k + 1]))
                                                   : 0.125f * (float(c[k]) + float(c[k + 2])) + 0.75f * float(c[k + 1]);
            }
        }
        for (int y = 0; y < fine; ++y)
            refine(rows.data(), 1, y, [&](int j, float v) { planes[std::size_t(z * fine + y)][std::size_t(j)] = v; });
    }
    Row low, high;
    low.fill(std::numeric_limits<float>::max()), high.fill(std::numeric_limits<float>::lowest());
    for (int z = 0; z < fine; ++z)
        for (int y = 0; y < fine; ++y)
            refine(planes.data() + y, fine, z, [&](int j, float v) {
                low[std::size_t(j)] = std::min(low[std::size_t(j)], v);
                high[std::size_t(j)] = std::max(high[std::size_t(j)], v);
            });
    return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

/// What values the spline can have in each cell, in stored units, rounding included; those of its voxels too.
template <class Voxel>
void find_cells(DeviceVolume::Data& data) {
    constexpr int margin = 1;
    constexpr float worth = 1.0f / 64;  // of all values: a range that is so much wider than its voxels' is refined
    const auto [nx, ny, nz] = data.dimensions;
    const int bricks_x = brick_count(nx), bricks_y = brick_count(ny);
    const kernel::VolumeView<Voxel> volume = view_of<Voxel>(data);
    const kernel::SplineView<Voxel>& view = volume.spline;
    const float wider = worth * (data.stored_max - data.stored_min);
    CellRanges codes = data.cells;
    parallel_for(
        data.device.threads, std::int64_t(bricks_x) * bricks_y * brick_count(nz), 1, [&](std::int64_t b, std::int64_t) {
            const std::array<int, 3> at{int(b % bricks_x), int(b / bricks_x % bricks_y),
                                        int(b / (std::int64_t(bricks_x) * bricks_y))};
            const Voxel* brick = view.coefficients + std::size_t(b) * brick_voxels;
            const int slices = slices_read(nz, at[2]);
            fill_cells(volume.voxels + std::size_t(b) * brick_voxels, at, slices, data.cells);
            fill_cells<Voxel, margin>(brick, at, slices, codes);
            for_each_cell(at, codes.count, [&](std::size_t cell, const std::array<int, 3>& first) {
                float &low = data.cells.low[cell], &high = data.cells.high[cell];
                kernel::Two<float> range{codes.low[cell], codes.high[cell]};
                if (view.stored(range.a) < low - wider || view.stored(range.b) > high + wider) {
                    const Voxel* corner =
                        brick + (first[2] - margin) * brick_slice + (first[1] - margin) * brick_row + first[0] - margin;
                    std::tie(range.a, range.b) = refined_range(corner, slices - first[2] + margin);
                }
                range = view.stored(range);
                low = std::min(low, range.a), high = std::max(high, range.b);
            });
        });
}

}  // namespace chiaro
