#include "illumination/visibility/density.h"

#include "core/threads.h"

namespace chiaro {
namespace {

/// Transmittance of the finer cells of one block, 1 outside the grid, [z][y][x].
using Block = std::array<float, 8>;

/// Mean over the four columns of 2 cells along an axis: `next` is the distance of the two, the others those of columns.
float column_mean(const Block& t, int next, int a, int b) {
    return 0.25f * (t[0] * t[next] + t[a] * t[a + next] + t[b] * t[b + next] + t[a + b] * t[a + b + next]);
}

constexpr float least_transmittance = 1e-30f;  ///< so that κ stays finite

float depth_of(const Block& t) {
    const float product = column_mean(t, 1, 2, 4) * column_mean(t, 2, 1, 4) * column_mean(t, 4, 1, 2);
    return std::max(-std::log(std::max(product, least_transmittance)) / 3, 0.0f);
}

template <class Transmittance>
Density halve(const CellGrid& finer, int threads, Progress& progress, const Transmittance& transmittance) {
    Density out(halved(finer));
    const auto [nx, ny, nz] = out.grid.count;
    const auto row = [&, nx = nx, ny = ny](std::int64_t r, std::int64_t) {
        const int y = int(r % ny), z = int(r / ny);
        float* to = out.data() + out.grid.index(0, y, z);
        for (int x = 0; x < nx; ++x) {
            Block block;
            for (int i = 0; i < 8; ++i) {
                const int cx = 2 * x + (i & 1), cy = 2 * y + (i >> 1 & 1), cz = 2 * z + (i >> 2);
                const bool inside = cx < finer.count[0] && cy < finer.count[1] && cz < finer.count[2];
                block[i] = inside ? transmittance(finer.index(cx, cy, cz)) : 1.0f;
            }
            to[x] = depth_of(block);
        }
    };
    parallel_for(threads, std::int64_t(ny) * nz, 16, "density", progress, [&](std::int64_t first, std::int64_t end) {
        for (auto r = first; r < end; ++r) row(r, r + 1);
    });
    progress.check();
    return out;
}

}  // namespace

CellGrid halved(const CellGrid& grid) {
    CellGrid half = grid;
    half.edge_mm = 2 * grid.edge_mm;
    half.is_voxel_grid = false;
    for (int axis = 0; axis < 3; ++axis) {
        half.count[axis] = (grid.count[axis] + 1) / 2;
        half.voxels_per_cell[axis] = 2 * grid.voxels_per_cell[axis];
    }
    return half;
}

Density halved(const Density& finer, int threads, Progress& progress) {
    return halve(finer.grid, threads, progress, [&](std::size_t i) { return std::exp(-finer.data()[i]); });
}

Density density_of(const CellOpacity& opacity, int threads, Progress& progress) {
    Density out(opacity.values.grid);
    const auto fill = [&](std::int64_t first, std::int64_t end) {
        for (std::int64_t i = first; i < end; ++i) {
            const float alpha = float(opacity.values.data()[i]) / cell_one;
            out.data()[i] = alpha > 0 ? -std::log1p(-std::min(alpha, 1 - 1e-7f)) : 0;
        }
    };
    parallel_for(threads, std::int64_t(out.grid.size()), 1 << 16, "density", progress, fill);
    progress.check();
    return out;
}

Density density_of(const CellOpacity& opacity, int subsample, int threads, Progress& progress) {
    if (subsample == 1) return density_of(opacity, threads, progress);
    Density density = halve(opacity.values.grid, threads, progress,
                            [&](std::size_t i) { return 1 - float(opacity.values.data()[i]) / cell_one; });
    for (int f = 2; f < subsample; f *= 2) density = halved(density, threads, progress);
    return density;
}

}  // namespace chiaro
