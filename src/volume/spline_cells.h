// Between which values a spline lies in each cell.
#pragma once
#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"
#include "volume/launch_spline.h"

namespace chiaro {

/// From between which codes the coefficients of each cell lie to what values the spline can have there, in stored
/// units, rounding included; data.cells hold those of its voxels, and then those too.
template <class Voxel>
class SplineCells {
public:
    SplineCells(DeviceVolume::Data& data, CellRanges& codes)
        : cells_(data.cells),
          codes_(codes),
          view_(view_of<Voxel>(data).spline),
          wider_(worth * (data.stored_max - data.stored_min)),
          run_(kernel::spline_functions_for(data.device.isa)) {}

    /// Of a brick, of which so many slices are there.
    void find(const Voxel* brick, const std::array<int, 3>& at, int slices) const {
        unsigned layers = 0;
        for_each_cell(at, cells_.count, [&](std::size_t cell, const std::array<int, 3>& first) {
            if (is_wide(cell)) layers |= 1u << first[2] / cell_edge;
        });
        kernel::CellBounds bounds;
        if (layers) run_.find_bounds(brick, slices, layers, bounds);
        for_each_cell(at, cells_.count, [&](std::size_t cell, const std::array<int, 3>& first) {
            kernel::Two<float> range{codes_.low[cell], codes_.high[cell]};
            if (is_wide(cell)) {
                const std::size_t in = kernel::CellBounds::index(first);
                range = {bounds.low[in], bounds.high[in]};
            }
            range = view_.stored(range);
            cells_.low[cell] = std::min(cells_.low[cell], range.a);
            cells_.high[cell] = std::max(cells_.high[cell], range.b);
        });
    }

private:
    static constexpr float worth =
        1.0f / 64;  // of all values: a range that is so much wider than its voxels' is refined

    bool is_wide(std::size_t cell) const {
        return view_.stored(codes_.low[cell]) < cells_.low[cell] - wider_ ||
               view_.stored(codes_.high[cell]) > cells_.high[cell] + wider_;
    }

    CellRanges &cells_, &codes_;
    kernel::SplineView<Voxel> view_;
    float wider_;
    kernel::CodeFunctions<Voxel> run_;
};

/// What values the spline can have in each cell, in stored units, rounding included; those of its voxels too, which
/// are there already where it borrows them.
template <class Voxel>
void find_cells(DeviceVolume::Data& data) {
    const auto [nx, ny, nz] = data.dimensions;
    const int bricks_x = brick_count(nx), bricks_y = brick_count(ny), layers = brick_count(nz);
    const kernel::VolumeView<Voxel> view = view_of<Voxel>(data);
    CellRanges codes = data.cells;
    const SplineCells<Voxel> cells(data, codes);
    parallel_for(data.device.threads, std::int64_t(bricks_x) * bricks_y * layers, 1, [&](std::int64_t b, std::int64_t) {
        const std::array<int, 3> at{int(b % bricks_x), int(b / bricks_x % bricks_y), int(b / bricks_x / bricks_y)};
        const std::size_t first = std::size_t(b) * brick_voxels;
        const int slices = slices_read(nz, at[2]);
        if (!data.bricks.is_borrowed()) fill_cells(view.voxels + first, at, slices, data.cells);
        fill_cells<Voxel, 1>(view.spline.coefficients + first, at, slices, codes);
        cells.find(view.spline.coefficients + first, at, slices);
    });
}

}  // namespace chiaro
