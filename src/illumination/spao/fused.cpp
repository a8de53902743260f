#include "illumination/spao/fused.h"

#include <cstring>
#include <optional>

#include "illumination/spao/coarse.h"
#include "illumination/spao/steps.h"

namespace chiaro {
namespace {

using Tile = kernel::SpaoTile;
using Cells = std::array<int, 3>;

}  // namespace

SpaoScratch& scratch_of_thread() {
    thread_local const auto scratch = std::make_unique<SpaoScratch>();
    return *scratch;
}

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

kernel::SpaoOutput output_of_cells(CellValues& access, const BlockMap& blocks, std::size_t block) {
    const auto [nx, ny, nz] = access.grid.count;
    const auto [x, y, z] = blocks.cells(block, access.grid.count);
    return {{access.data() + access.grid.index(x.first, y.first, z.first)},
            nx,
            std::int64_t(nx) * ny,
            x.second - x.first,
            y.second - y.first,
            z.second - z.first,
            blocks.pieces_of(block).bits};
}

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
        for_blocks(grid.needed(), [&](std::size_t, const Cells& first, SpaoScratch& scratch) {
            kernel::SpaoBlock block = block_on(g, first, scratch);
            block.weight = grid.weights(first);
            load_tile(grid.opacity(), first, scratch.tile);
            run_.corners(scratch.tile, block, grid.output(first));
        });
    }

    CellValues sweep_cells() {
        CellValues access(opacity_.values.grid);
        const kernel::OpacityGrid grid = opacity_grid(access.grid.count, opacity_.values.data());
        for_blocks(blocks_, [&](std::size_t b, const Cells& first, SpaoScratch& scratch) {
            const kernel::SpaoBlock block = block_on(0, first, scratch);
            load_tile(grid, first, scratch.tile);
            run_.cells(scratch.tile, block, output_of_cells(access, blocks_, b));
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
                         const auto [x, y, z] = map.at(blocks[b]);
                         work(blocks[b], Cells{x * block_edge, y * block_edge, z * block_edge}, scratch_of_thread());
                     });
        progress_.check();
    }

    kernel::SpaoBlock block_on(int g, const Cells& first, SpaoScratch& scratch) const {
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
    return fused_steps(sweep, settings, timer);
}

}  // namespace chiaro
