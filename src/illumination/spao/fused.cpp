#include "illumination/spao/fused.h"

#include <cstring>
#include <optional>

#include "illumination/spao/coarse.h"

namespace chiaro {
namespace {

using Tile = kernel::SpaoTile;
using Cells = std::array<int, 3>;

/// Everything that one thread needs for a block.
struct Scratch {
    Tile tile;
    kernel::CoarseTile coarse;
};

/// The block's cells and `halo` around them; beyond the grid nothing.
void load_tile(const kernel::OpacityGrid& grid, const Cells& first, Tile& tile) {
    const auto [nx, ny, nz] = grid.count;
    const int x0 = first[0] - Tile::halo, begin = std::clamp(-x0, 0, Tile::row),
              end = std::clamp(nx - x0, begin, Tile::row);
    for (int k = 0; k < Tile::row; ++k)
        for (int j = 0; j < Tile::row; ++j) {
            const int y = first[1] - Tile::halo + j, z = first[2] - Tile::halo + k;
            std::uint16_t* to = tile.opacity + k * Tile::slice + j * Tile::row;
            std::memset(to, 0, Tile::row * sizeof *to);
            if (y >= 0 && y < ny && z >= 0 && z < nz && end > begin)
                std::copy_n(grid.row(y, z) + x0 + begin, end - begin, to + begin);
        }
}

}  // namespace

kernel::SpaoBlock spao_block(const SpaoSettings& settings, bool goes_on) {
    const int octants = octants_of(settings.model);
    return {
        .product = kernel::SpaoProduct(settings.model),
        .last = std::min(settings.levels, Tile::shells) - 1,
        .normal_factor = float(settings.normal_factor),
        .octants = octants,
        .goes_on = goes_on,
        .weighs = goes_on && octants > 1,
    };
}

namespace {

class FusedSweep {
public:
    FusedSweep(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings, const BlockMap& blocks,
               Progress& progress)
        : device_(device),
          run_(kernel::spao_functions_for(device.isa)),
          opacity_(opacity),
          settings_(settings),
          blocks_(blocks),
          progress_(progress) {}

    void make_coarse_grids() {
        for (int g = 1; g <= coarse_grids(settings_); ++g) {
            CoarseGrid grid = g == 1 ? CoarseGrid(opacity_, octants_of(settings_.model), device_, progress_)
                                     : CoarseGrid(coarse_.back(), device_, progress_);
            grid.need(g == 1 ? blocks_ : coarse_.back().needed());
            coarse_.push_back(std::move(grid));
        }
    }

    /// Grid g > 0: its shell, joined to those of the coarser ones.
    void sweep_corners(int g) {
        CoarseGrid& grid = coarse_[g - 1];
        for_blocks(grid.needed(), [&](std::size_t, const Cells& first, Scratch& scratch) {
            kernel::SpaoBlock block = block_on(g, first, scratch);
            block.weight = grid.weights(first);
            load_tile(grid.opacity(), first, scratch.tile);
            run_.corners(scratch.tile, block, grid.output(first));
        });
    }

    CellValues sweep_cells() {
        CellValues access(opacity_.values.grid);
        const kernel::OpacityGrid grid = opacity_grid(access.grid.count, opacity_.values.data());
        const auto [nx, ny, nz] = grid.count;
        for_blocks(blocks_, [&, nx = nx, ny = ny, nz = nz](std::size_t b, const Cells& first, Scratch& scratch) {
            const kernel::SpaoBlock block = block_on(0, first, scratch);
            load_tile(grid, first, scratch.tile);
            kernel::SpaoOutput to{{access.data() + access.grid.index(first[0], first[1], first[2])},
                                  nx,
                                  std::int64_t(nx) * ny,
                                  std::min(block_edge, nx - first[0]),
                                  std::min(block_edge, ny - first[1]),
                                  std::min(block_edge, nz - first[2]),
                                  blocks_.pieces_of(b).bits};
            run_.cells(scratch.tile, block, to);
        });
        return access;
    }

private:
    /// work(block, its first cell or corner, scratch)
    template <class Work>
    void for_blocks(const BlockMap& map, Work&& work) {
        const auto blocks = map.held();
        parallel_for(device_.threads, std::int64_t(blocks.size()), 1, "spao", progress_,
                     [&](std::int64_t b, std::int64_t) {
                         thread_local const auto scratch = std::make_unique<Scratch>();
                         const auto [x, y, z] = map.at(blocks[b]);
                         work(blocks[b], Cells{x * block_edge, y * block_edge, z * block_edge}, *scratch);
                     });
        progress_.check();
    }

    kernel::SpaoBlock block_on(int g, const Cells& first, Scratch& scratch) const {
        const bool has_coarser = g < int(coarse_.size());
        if (has_coarser) coarse_[g].load(first, scratch.coarse);
        kernel::SpaoBlock block = spao_block(settings_, has_coarser);
        block.tile = &scratch.tile, block.coarse = &scratch.coarse;
        return block;
    }

    const Device& device_;
    const kernel::SpaoFunctions run_;
    const CellOpacity& opacity_;
    const SpaoSettings& settings_;
    const BlockMap& blocks_;
    Progress& progress_;
    std::vector<CoarseGrid> coarse_;  ///< of cells twice, four times, ... as wide
};

}  // namespace

CellValues fused_sweep(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                       const BlockMap& blocks, StageTimer& timer, Progress& progress) {
    FusedSweep sweep(device, opacity, settings, blocks, progress);
    timer("spao mipmaps", [&] { sweep.make_coarse_grids(); });
    for (int g = coarse_grids(settings); g > 0; --g) timer(name_of_cells(g), [&] { sweep.sweep_corners(g); });
    return timer(name_of_cells(0), [&] { return sweep.sweep_cells(); });
}

}  // namespace chiaro
