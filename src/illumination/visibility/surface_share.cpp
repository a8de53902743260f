#include "illumination/visibility/surface_share.h"

#include <algorithm>
#include <cmath>

#include "classify/surface_table.h"
#include "cuda/executor.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/visibility/surface_share_kernel.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

constexpr double margin_edges = 1;  ///< surfaces often begin just before the node that they make dense
constexpr double apart_edges = 1.5;
constexpr int max_points = 4;  ///< per axis

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
    const int points = std::clamp(int(std::ceil(wide / apart_edges - 1e-6)), 1, max_points);
    run_steps(device, &progress, [&](auto& executor) {
        const auto made = executor.template output<float>(shares.buffer);
        with_stored_voxel(volume, [&](auto voxel) {
            using Voxel = decltype(voxel);
            kernel::SurfaceShareKernel<Voxel> kernel{view_of<Voxel>(volume),   table->view(), {}, {}, points, {},
                                                     executor.values(density), made.data()};
            for (int axis = 0; axis < 3; ++axis) {
                const double cells = grid.voxels_per_cell[axis];
                kernel.voxels_per_cell[axis] = float(cells), kernel.count[axis] = grid.count[axis];
                kernel.step[axis] =
                    float((cells + 2 * margin_edges * edge / volume.geometry.spacing_mm[axis]) / points);
            }
            HostArrays arrays;
            volume.add_to(arrays), arrays.add(table, table->opacity());
            executor.exchange(arrays, kernel.volume.voxels, kernel.volume.spline.coefficients,
                              kernel.volume.factor.entries, kernel.surface.opacity);
            executor.for_each_node(grid.count, kernel, "surfaces");
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
