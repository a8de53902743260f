#include "illumination/visibility/surface_share.h"

#include <algorithm>
#include <cmath>

#include "classify/surface_table.h"
#include "cuda/executor.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/visibility/launch_shares.h"
#include "illumination/visibility/surface_share_kernel.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

constexpr double margin_edges = 1;  ///< surfaces often begin just before the node that they make dense
constexpr double apart_edges = 1.5;

/// On the CPU row by row, several points at a time.
template <class Voxel>
void find(CpuExecutor& executor, const kernel::SurfaceShareKernel<Voxel>& kernel, const Device& device) {
    const auto run = kernel::share_row_for<Voxel>(device.isa);
    const int rows = kernel.count[1];
    executor.for_each(
        std::int64_t(rows) * kernel.count[2],
        [&](std::int64_t row) { run(kernel, std::int32_t(row % rows), std::int32_t(row / rows)); }, "surfaces", 8);
}
template <class Voxel>
void find(GpuExecutor& executor, const kernel::SurfaceShareKernel<Voxel>& kernel, const Device&) {
    executor.for_each_node({kernel.count[0], kernel.count[1], kernel.count[2]}, kernel, "surfaces");
}

}  // namespace

Density shares_of_surface(const Medium::Data& medium, const Density& density, const Device& device,
                          Progress& progress) {
    const CellGrid& grid = density.grid;
    Density shares(grid);
    if (medium.shape.mode == Mode::iso) {
        std::fill_n(shares.numbers(), grid.size(), 1.0f);
        return shares;
    }
    const DeviceVolume::Data& volume = medium.volume.data();
    const std::shared_ptr<const SurfaceTable> table = surface_table_of(medium);
    const double edge = volume.geometry.smallest_spacing_mm(), wide = grid.edge_mm / edge + 2 * margin_edges;
    const int points = std::clamp(int(std::ceil(wide / apart_edges - 1e-6)), 1, kernel::SharePoints::most_per_axis);
    float step[3];  // from point to point, voxels
    for (int axis = 0; axis < 3; ++axis)
        step[axis] =
            float((grid.voxels_per_cell[axis] + 2 * margin_edges * edge / volume.geometry.spacing_mm[axis]) / points);
    run_steps(device, &progress, [&](auto& executor) {
        const auto made = executor.template output<float>(shares.buffer);
        with_stored_voxel(volume, [&](auto voxel) {
            using Voxel = decltype(voxel);
            const auto of_axis = [&](int axis) { return float(grid.voxels_per_cell[axis]); };
            kernel::SurfaceShareKernel<Voxel> kernel{view_of<Voxel>(volume),
                                                     table->view(),
                                                     {of_axis(0), of_axis(1), of_axis(2)},
                                                     {grid.count[0], grid.count[1], grid.count[2]},
                                                     executor.values(density),
                                                     made.data(),
                                                     kernel::SharePoints(points, step)};
            HostArrays arrays;
            volume.add_to(arrays), arrays.add(table, table->opacity());
            executor.exchange(arrays, kernel.volume.voxels, kernel.volume.spline.coefficients,
                              kernel.volume.factor.entries, kernel.surface.opacity);
            find(executor, kernel, device);
            executor.synchronize();
        });
        made.keep();
    });
    if (device.is_shared()) gather_nodes(device, volume, grid, shares.numbers());
    return shares;
}

Density halved_shares(const Density& finer) {
    const CellGrid& grid = finer.grid;
    Density coarse(halved(grid));
    float* shares = coarse.numbers();
    std::fill_n(shares, coarse.grid.size(), 0.0f);
    const float* from = finer.data();
    for (int z = 0; z < grid.count[2]; ++z)
        for (int y = 0; y < grid.count[1]; ++y)
            for (int x = 0; x < grid.count[0]; ++x) {
                float& share = shares[coarse.grid.index(x / 2, y / 2, z / 2)];
                share = std::max(share, from[grid.index(x, y, z)]);
            }
    return coarse;
}

}  // namespace chiaro
