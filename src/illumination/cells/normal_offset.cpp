#include "illumination/cells/normal_offset.h"

#include <optional>

#include "core/threads.h"
#include "illumination/cells/gpu.h"
#include "illumination/cells/launch.h"
#include "illumination/cells/launch_gpu.h"

namespace chiaro {
namespace {

using Tile = kernel::NormalOffsetTile;

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

SliceWork slice_lifter(const Device& device, const CellRows& access, const CellRows& opacity, double normal_factor,
                       const BlockMap& map, CellValues& out) {
    const auto normal_offset = kernel::normal_offset_block_for(device.isa);
    return [=, &map, &out](std::array<int, 2> column, int first, int end) {
        thread_local std::vector<std::uint16_t> tiles(2 * Tile::size);
        thread_local std::vector<float> numbers(2 * Tile::size + 16);
        const auto [x, y, z] = map.cells(map.index(column[0], column[1], 0), out.grid.count);
        const BlockPieces pieces = map.pieces_of_slices(column, first, end);
        load_tile(access, {x.first, y.first, first}, end - first, Beyond::nearest, &tiles[0]);
        load_tile(opacity, {x.first, y.first, first}, end - first, Beyond::nothing, &tiles[Tile::size]);
        const auto [nx, ny, nz] = out.grid.count;
        normal_offset({.access = &tiles[0],
                       .opacity = &tiles[Tile::size],
                       .normal_factor = float(normal_factor),
                       .pieces = pieces.bits,
                       .out = out.data() + out.grid.index(x.first, y.first, first),
                       .row = nx,
                       .slice = std::int64_t(nx) * ny,
                       .nx = x.second - x.first,
                       .ny = y.second - y.first,
                       .nz = end - first},
                      &numbers[0]);
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
    const auto normal_offset = slice_lifter(device, rows_of(access), rows_of(opacity), normal_factor, map, out);
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "lift", progress, [&](std::int64_t b, std::int64_t) {
        const auto [x, y, z] = map.at(blocks[b]);
        normal_offset({x, y}, z * block_edge, std::min((z + 1) * block_edge, out.grid.count[2]));
    });
    progress.check();
    return out;
}

}  // namespace chiaro
