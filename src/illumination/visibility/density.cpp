#include "illumination/visibility/density.h"

#include <cstring>

#include "classify/medium.h"
#include "core/threads.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/launch_density.h"
#include "illumination/visibility/sub_voxel.h"

namespace chiaro {
namespace {

using Tile = std::vector<float>;

/// A tile of edge³ cells to one of (edge / 2)³ nodes.
Tile halved(const Tile& cells, int edge, const kernel::DensityRows& rows) {
    // Whole vectors are written, which the eight cells of the last tile are not.
    Tile open(cells.size()), nodes(std::max<std::size_t>(cells.size() / 8, kernel::max_nodes));
    rows.transmittance(cells.data(), int(cells.size()), open.data());
    const int half = edge / 2;
    for (int z = 0; z < half; ++z)
        for (int y = 0; y < half; ++y) {
            const float* first = open.data() + (2 * z * edge + 2 * y) * edge;
            rows.halve({{first, first + edge, first + edge * edge, first + edge * edge + edge}}, half,
                       nodes.data() + (z * half + y) * half);
        }
    return nodes;
}

/// The nodes of a tile that lie within the grid.
void keep(const Tile& tile, int edge, const std::array<int, 3>& block, Density& out) {
    const auto along = [&](int axis) {
        const int first = block[axis] * edge;
        return std::pair{first, std::min(first + edge, out.grid.count[axis])};
    };
    const auto x = along(0), y = along(1), z = along(2);
    for (int k = z.first; k < z.second; ++k)
        for (int j = y.first; j < y.second; ++j)
            std::copy_n(tile.data() + ((k - z.first) * edge + j - y.first) * edge, x.second - x.first,
                        out.numbers() + out.grid.index(x.first, j, k));
}

/// Block by block, halved in the cache as often as asked: blocks of 32³ end in whole nodes.
Density assemble(const CellGrid& cells, const BlockMap& blocks, int halvings, const BlockDepths& depths,
                 const Device& device, Progress& progress) {
    Density out(coarser(cells, 1 << halvings));
    const auto on_gpu = [&] { assemble_on_gpu(device, blocks, halvings, depths, out, progress); };
    if (cuda::try_gpu(device, on_gpu)) return out;
    const auto rows = kernel::density_rows_for(device.isa);
    const auto held = blocks.held();
    parallel_for(device.threads, std::int64_t(held.size()), 1, "density", progress, [&](std::int64_t b, std::int64_t) {
        Tile tile(tile_size);
        depths.here(held[b], tile.data());
        for (int i = 0; i < halvings; ++i) tile = halved(tile, block_edge >> i, rows);
        keep(tile, block_edge >> halvings, blocks.at(held[b]), out);
    });
    progress.check();
    return out;
}

int log2_of(int subsample) { return subsample == 1 ? 0 : 1 + log2_of(subsample / 2); }

}  // namespace

bool is_same(const Density& a, const Density& b) {
    return &a == &b || (a.grid.count == b.grid.count && a.grid.edge_mm == b.grid.edge_mm &&
                        a.grid.voxels_per_cell == b.grid.voxels_per_cell &&
                        std::memcmp(a.data(), b.data(), a.grid.size() * sizeof(float)) == 0);
}

CellGrid halved(const CellGrid& grid) { return coarser(grid, 2); }

Density halved(const Density& finer, const Device& device, Progress& progress) {
    const BlockMap all(finer.grid.count, true);
    return assemble(finer.grid, all, 1, block_depths(finer, all), device, progress);
}

Density density_for(const Medium::Data& medium, int subsample, const Device& device, Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const CellGrid cells = make_cell_grid(volume.dimensions, volume.geometry);
    check_ghosts(volume, coarser(cells, subsample));
    const auto own = [&] {
        if (medium.shape.mode == Mode::iso)
            return density_of(cell_opacity(device, medium, progress), subsample, device, progress);
        const BlockMap matter = visible_blocks(medium, cells, 1);
        return assemble(cells, matter, log2_of(subsample), block_depths(medium, cells, matter), device, progress);
    };
    Density density = own();
    if (device.is_shared()) gather_nodes(device, volume, density.grid, density.numbers());
    return density;
}

Density density_of(const CellOpacity& opacity, int subsample, const Device& device, Progress& progress) {
    return assemble(opacity.values.grid, opacity.matter, log2_of(subsample), block_depths(opacity), device, progress);
}

}  // namespace chiaro
