#include "illumination/spao/fused.h"

#include <optional>

#include "illumination/spao/coarse.h"
#include "illumination/spao/steps.h"

namespace chiaro {
namespace {

using Cells = std::array<int, 3>;

}  // namespace

kernel::SpaoTile& tile_of_thread() {
    using Loaded = kernel::CellTile;  // as load_tile has it
    static_assert(kernel::SpaoTile::halo == Loaded::halo && kernel::SpaoTile::size == Loaded::size);
    thread_local const auto tile = std::make_unique<kernel::SpaoTile>();
    return *tile;
}

kernel::SpaoOutput output_of_cells(const RowsOf<std::uint16_t>& access, const BlockMap& blocks, std::size_t block) {
    const auto [nx, ny, nz] = access.count;
    const auto [x, y, z] = blocks.cells(block, access.count);
    return {{access.row(y.first, z.first) + x.first},
            nx,
            std::int64_t(nx) * ny,
            x.second - x.first,
            y.second - y.first,
            z.second - z.first,
            blocks.pieces_of(block).bits};
}

kernel::SpaoBlock spao_block(const SpaoSettings& settings, bool of_surfaces, bool goes_on) {
    const int octants = octants_of(settings.model);
    return {
        .product = kernel::SpaoProduct(settings.model),
        .last = std::min(settings.levels, kernel::SpaoTile::shells) - 1,
        .normal_factor = float(settings.normal_factor),
        .of_surfaces = of_surfaces,
        .octants = octants,
        .goes_on = goes_on,
    };
}

namespace {

class FusedSweep {
public:
    FusedSweep(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings, bool of_surfaces,
               const BlockMap& blocks, Progress& progress)
        : device_(device),
          run_(kernel::spao_functions_for(device.isa)),
          opacity_(opacity),
          settings_(settings),
          of_surfaces_(of_surfaces),
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
        for_blocks(grid.needed(), [&](std::size_t b, const Cells& first, kernel::SpaoTile& tile) {
            kernel::SpaoBlock block = block_on(g, first, tile);
            grid.weigh(first, block);
            load_tile(grid.cells(), first, tile.opacity);
            run_.corners(tile, block, grid.output(first, block_edge, grid.needed().pieces_of(b)));
        });
    }

    CellValues sweep_cells() {
        CellValues access(opacity_.values.grid);
        const CellRows opacity = rows_of(opacity_.values);
        for_blocks(blocks_, [&](std::size_t b, const Cells& first, kernel::SpaoTile& tile) {
            const kernel::SpaoBlock block = block_on(0, first, tile);
            load_tile(opacity, first, tile.opacity);
            run_.cells(tile, block, output_of_cells(rows_of(access), blocks_, b));
        });
        return access;
    }

private:
    /// work(block, its first cell or corner, tile)
    template <class Work>
    void for_blocks(const BlockMap& map, Work&& work) {
        const auto blocks = map.held();
        parallel_for(device_.threads, std::int64_t(blocks.size()), 1, "spao", progress_,
                     [&](std::int64_t b, std::int64_t) {
                         const auto [x, y, z] = map.at(blocks[b]);
                         work(blocks[b], Cells{x * block_edge, y * block_edge, z * block_edge}, tile_of_thread());
                     });
        progress_.check();
    }

    kernel::SpaoBlock block_on(int g, const Cells& first, kernel::SpaoTile& tile) const {
        const bool has_coarser = g < int(coarse_.size());
        kernel::SpaoBlock block = spao_block(settings_, of_surfaces_, has_coarser);
        block.tile = &tile;
        if (has_coarser) block.coarse = coarse_[g].rows_for(first);
        return block;
    }

    const Device& device_;
    const kernel::SpaoFunctions run_;
    const CellOpacity& opacity_;
    const SpaoSettings& settings_;
    const bool of_surfaces_;
    const BlockMap& blocks_;
    Progress& progress_;
    std::vector<CoarseGrid> coarse_;  ///< of cells twice, four times, ... as wide
};

}  // namespace

CellValues fused_sweep(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                       const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces) {
    FusedSweep sweep(device, opacity, settings, of_surfaces, blocks, progress);
    return fused_steps(sweep, settings, timer);
}

}  // namespace chiaro
