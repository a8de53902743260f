#include "illumination/cells/normal_offset.h"

#include <optional>

#include "core/threads.h"
#include "illumination/cells/gpu.h"
#include "illumination/cells/launch.h"
#include "illumination/cells/launch_gpu.h"

namespace chiaro {
namespace {

using Tile = kernel::NormalOffsetTile;
using Block = std::array<std::pair<int, int>, 3>;

/// A block and two cells around it; beyond the grid the nearest cell, or nothing.
void load_tile(const CellValues& values, const Block& block, bool nearest, float* tile) {
    const auto [nx, ny, nz] = values.grid.count;
    for (int k = 0; k < Tile::row; ++k)
        for (int j = 0; j < Tile::row; ++j) {
            const int x0 = block[0].first - Tile::halo, y = block[1].first - Tile::halo + j,
                      z = block[2].first - Tile::halo + k;
            float* to = tile + k * Tile::slice + j * Tile::row;
            const bool outside = y < 0 || y >= ny || z < 0 || z >= nz;
            const std::uint16_t* row =
                values.data() + values.grid.index(0, std::clamp(y, 0, ny - 1), std::clamp(z, 0, nz - 1));
            const int begin = std::max(0, -x0), end = std::clamp(nx - x0, begin, Tile::row);
            if (outside && !nearest) {
                std::fill_n(to, Tile::row, 0.0f);
                continue;
            }
            std::fill_n(to, begin, nearest ? row[0] / cell_one : 0);
            for (int i = begin; i < end; ++i) to[i] = row[x0 + i] / cell_one;
            std::fill(to + end, to + Tile::row, nearest ? row[nx - 1] / cell_one : 0);
        }
}

CellValues normal_offset_on_gpu(const Device& device, const CellValues& access, const CellValues& opacity,
                                double normal_factor, const BlockMap& map, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto [nx, ny, nz] = access.grid.count;
    GpuCells out(device, access.grid);
    const std::size_t together = std::clamp<std::size_t>(map.held().size(), 1, blocks_together);
    const cuda::Array<float> tiles(stream, together * 2 * Tile::size);
    kernel::NormalOffsetBatch batch{.tiles = tiles.data(),
                                    .access = access.on_gpu(stream),
                                    .opacity = opacity.on_gpu(stream),
                                    .count = {nx, ny, nz},
                                    .normal_factor = float(normal_factor),
                                    .out = out.data()};
    for_blocks(stream, map, "lift", progress, [&](const kernel::BlockPlace* places, std::int64_t blocks) {
        batch.places = places;
        kernel::normal_offset_blocks(stream, batch, blocks);
    });
    return out.release();
}

}  // namespace

CellValues normal_offset_off_surfaces(const Device& device, const CellValues& access, const CellValues& opacity,
                                      double normal_factor, const BlockMap& map, Progress& progress) {
    std::optional<CellValues> made;
    const auto on_gpu = [&] {
        made.emplace(normal_offset_on_gpu(device, access, opacity, normal_factor, map, progress));
    };
    if (cuda::try_gpu(device, on_gpu)) return *std::move(made);
    CellValues out(access.grid);
    const auto normal_offset = kernel::normal_offset_block_for(device.isa);
    const auto blocks = map.held();
    const auto work = [&](std::int64_t b, std::int64_t) {
        thread_local std::vector<float> tiles(2 * Tile::size);
        thread_local std::vector<std::uint16_t> displaced(Tile::edge * Tile::edge * Tile::edge);
        const Block block = map.cells(blocks[b], out.grid.count);
        load_tile(access, block, true, &tiles[0]);
        load_tile(opacity, block, false, &tiles[Tile::size]);
        normal_offset(&tiles[0], &tiles[Tile::size], float(normal_factor), map.pieces_of(blocks[b]).bits,
                      displaced.data());
        const auto [x, y, z] = block;
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                std::copy_n(&displaced[((k - z.first) * Tile::edge + j - y.first) * Tile::edge], x.second - x.first,
                            out.data() + out.grid.index(x.first, j, k));
    };
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "lift", progress, work);
    progress.check();
    return out;
}

}  // namespace chiaro
