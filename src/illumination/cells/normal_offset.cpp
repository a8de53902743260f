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

/// What is asked for of slices that may begin within a block.
BlockPieces pieces_of_slices(const BlockMap& map, std::array<int, 2> column, int first, int end) {
    constexpr int height = BlockPieces::height;
    BlockPieces pieces{};
    for (int z = first; z < end; z += height) {
        const std::size_t block = map.index(column[0], column[1], z / block_edge);
        if (map.holds[block])
            std::copy_n(map.pieces_of(block).bits[z % block_edge / height], block_edge / height,
                        pieces.bits[(z - first) / height]);
    }
    return pieces;
}

/// Of a block, the pieces that are asked for.
void copy_pieces(const std::vector<std::uint16_t>& from, const Block& block, const BlockPieces& pieces,
                 CellValues& out) {
    constexpr int width = BlockPieces::width;
    const auto [x, y, z] = block;
    for (int k = 0; k < z.second - z.first; ++k)
        for (int j = 0; j < y.second - y.first; ++j)
            for (int i = 0; i < x.second - x.first; i += width)
                if (kernel::is_asked(pieces.bits, i, j, k))
                    std::copy_n(&from[(k * Tile::edge + j) * Tile::edge + i], std::min(width, x.second - x.first - i),
                                out.data() + out.grid.index(x.first + i, y.first + j, z.first + k));
}

}  // namespace

SliceWork slice_lifter(const Device& device, const CellValues& access, const CellValues& opacity, double normal_factor,
                       const BlockMap& map, CellValues& out) {
    const auto normal_offset = kernel::normal_offset_block_for(device.isa);
    return [=, &access, &opacity, &map, &out](std::array<int, 2> column, int first, int end) {
        thread_local std::vector<float> tiles(2 * Tile::size);
        thread_local std::vector<std::uint16_t> displaced(Tile::edge * Tile::edge * Tile::edge);
        Block block = map.cells(map.index(column[0], column[1], 0), out.grid.count);
        block[2] = {first, end};
        const BlockPieces pieces = pieces_of_slices(map, column, first, end);
        load_tile(access, block, true, &tiles[0]);
        load_tile(opacity, block, false, &tiles[Tile::size]);
        normal_offset(&tiles[0], &tiles[Tile::size], float(normal_factor), pieces.bits, displaced.data());
        copy_pieces(displaced, block, pieces, out);
    };
}

CellValues normal_offset_off_surfaces(const Device& device, const CellValues& access, const CellValues& opacity,
                                      double normal_factor, const BlockMap& map, Progress& progress) {
    std::optional<CellValues> made;
    const auto on_gpu = [&] {
        made.emplace(normal_offset_on_gpu(device, access, opacity, normal_factor, map, progress));
    };
    if (cuda::try_gpu(device, on_gpu)) return *std::move(made);
    CellValues out(access.grid);
    const auto blocks = map.held();
    const auto normal_offset = slice_lifter(device, access, opacity, normal_factor, map, out);
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "lift", progress, [&](std::int64_t b, std::int64_t) {
        const auto [x, y, z] = map.at(blocks[b]);
        normal_offset({x, y}, z * block_edge, std::min((z + 1) * block_edge, out.grid.count[2]));
    });
    progress.check();
    return out;
}

}  // namespace chiaro
