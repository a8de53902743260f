#include "illumination/spao/layers.h"

#include "classify/medium.h"
#include "illumination/cells/rank_nodes.h"
#include "illumination/cells/spare_values.h"
#include "illumination/cells/surface_share.h"
#include "illumination/spao/coarse.h"
#include "illumination/spao/fused.h"

namespace chiaro {
namespace {

constexpr int half_edge = block_edge / 2;
constexpr int margin = 4;  ///< slices that are asked for beyond a layer: the halos of tiles, a piece
constexpr int rank_margin = int(access_reach) + 6;  ///< voxels that the cells samples read look at: two shells, corners
constexpr std::size_t busy_blocks = 64;             ///< so many at a time keep all threads at work
constexpr double crowded = 0.9;                     ///< share of blocks from which on large pages waste nothing

class LayeredLight {
public:
    LayeredLight(const Device& device, const Medium::Data& medium, const SpaoSettings& settings, StageTimer& timer,
                 Progress& progress)
        : device_(device),
          volume_(medium.volume.data()),
          settings_(settings),
          run_(kernel::spao_functions_for(device.isa)),
          steps_(timer),
          progress_(progress),
          maps_(opacity_maps(medium)),
          asked_(visible_blocks(medium, grid(), access_reach)),
          layers_(asked_.count[2]),
          together_(layers_at_once(asked_)),
          keeps_opacity_(together_ >= layers_ || takes_long(medium, grid())),
          opacity_(grid().count, keeps_opacity_ ? grid().count[2] : together_ * block_edge + 2 * margin),
          access_(values_to_write(grid(), asked_, is_sparse(), device.threads)),
          fill_(opacity_filler(medium, maps_, opacity_.rows())) {
        check_ghosts(volume_, grid(), rank_margin);
    }

    CellValues run() {
        if (coarse_grids(settings_) > 0) find_coarse();
        for (int first = 0; first < layers_; first += together_) {
            const int end = std::min(first + together_, layers_);
            fill_up_to(end * block_edge + margin);
            if (!coarse_.empty()) steps_.part(name_of_cells(1), [&] { sweep_corners(first, end); });
            steps_.part(name_of_cells(0), [&] { sweep_cells(first, end); });
            discard_before(end);
            progress_.report("spao", double(end) / layers_);
        }
        return std::move(access_);
    }

private:
    const CellGrid& grid() const { return maps_.grid; }
    CellRows opacities() { return opacity_.rows(); }
    /// Whether large pages would waste memory.
    bool is_sparse() const { return double(asked_.held().size()) < crowded * double(asked_.holds.size()); }
    /// Whether opacities take longer to find than to keep: those of surfaces, and of a spline between voxels.
    static bool takes_long(const Medium::Data& medium, const CellGrid& grid) {
        return medium.shape.mode == Mode::iso || (medium.volume.data().source && !grid.is_voxel_grid);
    }
    static int layers_at_once(const BlockMap& blocks) {
        const std::size_t layer = std::size_t(blocks.count[0]) * blocks.count[1];
        return std::clamp(int(busy_blocks / layer), 1, blocks.count[2]);
    }

    /// work(i) for i in [0, count)
    template <class Work>
    void for_all(std::size_t count, const Work& work) {
        parallel_for(device_.threads, std::int64_t(count), 1, [&](std::int64_t i, std::int64_t) {
            if (!progress_.cancelled()) work(std::size_t(i));
        });
        progress_.check();
    }

    /// Slices of opacities.
    void fill_up_to(int last) {
        steps_.part("opacity", [&] {
            const int end = std::min(last, grid().count[2]);
            for (int next = 0; filled_ < end; filled_ = next) {
                next = std::min(filled_ + block_edge, end);
                const auto columns = every_column_.columns(filled_, next);
                for_all(columns.size(), [&](std::size_t i) { fill_(columns[i], filled_, next); });
            }
        });
    }

    /// All that is coarser than the finest corners, whose cells are kept for them.
    void find_coarse() {
        const int octants = octants_of(settings_.model), grids = coarse_grids(settings_);
        coarse_.emplace_back(grid().count, octants);
        if (grids > 1) coarse_.emplace_back(coarse_[0].shape().count, octants);
        for (CoarseGrid& grid : coarse_)
            if (is_sparse()) grid.use_small_pages();
        for (int first = 0; first < layers_; first += together_) {
            const int end = std::min(first + together_, layers_);
            fill_up_to(end * block_edge);
            steps_.part("spao mipmaps", [&] { shrink_layers(first, end); });
            progress_.report("opacity", double(end) / layers_);
            progress_.check();
        }
        share_coarse();
        if (!keeps_opacity_) filled_ = 0;
        steps_.part("spao mipmaps", [&] {
            coarse_[0].need(asked_);
            for (int g = 2; g <= grids; ++g) {
                if (g > 2) coarse_.emplace_back(coarse_.back(), device_, progress_);
                if (g == 2) coarse_[1].shrink(coarse_[0].cells(), nullptr, device_, 0, coarse_[1].shape().count[2]);
                coarse_[std::size_t(g) - 1].need(coarse_[std::size_t(g) - 2].needed());
            }
        });
        for (int g = grids; g > 1; --g) {
            steps_.part(name_of_cells(g), [&] { sweep_all_corners(g); });
            if (coarse_.size() > std::size_t(g)) coarse_.pop_back();
        }
        if (grids > 1) coarse_[1].free_cells();
    }

    /// Of several ranks: wider shells know all of the volume.
    void share_coarse() {
        gather_nodes(device_, volume_, coarser(grid(), 2), coarse_[0].written_cells());
        if (coarse_.size() == 1 || octants_of(settings_.model) == 1) return;
        CellGrid corners = coarser(grid(), 4);
        corners.count = coarse_[1].corners();
        gather_nodes(device_, volume_, corners, coarse_[1].corner_weights());
    }

    /// Cells of the first coarse grid and weights of the second, from layers of opacities that then may go.
    void shrink_layers(int first, int end) {
        const auto until = [&](int last, int whole) { return end == layers_ ? whole : last; };
        CoarseGrid& grid1 = coarse_[0];
        grid1.shrink(opacities(), &maps_.matter, device_, first * half_edge,
                     until(end * half_edge, grid1.shape().count[2]));
        if (coarse_.size() > 1)
            coarse_[1].find_weights(opacities(), maps_.matter, 2, device_, first * half_edge / 2,
                                    until(end * half_edge / 2, coarse_[1].corners()[2]));
    }

    /// Grid g > 1, whole.
    void sweep_all_corners(int g) {
        const BlockMap& needed = coarse_[std::size_t(g) - 1].needed();
        const auto blocks = needed.held();
        for_all(blocks.size(), [&](std::size_t i) {
            const auto [x, y, z] = needed.at(blocks[i]);
            sweep_block(g, {x * block_edge, y * block_edge, z * block_edge}, block_edge, needed.pieces_of(blocks[i]));
        });
    }

    /// Of the first coarse grid, what the cells of some layers read.
    void sweep_corners(int first, int end) {
        CoarseGrid& grid1 = coarse_[0];
        const int begin = first * half_edge, stop = std::min(end * half_edge + 1, grid1.corners()[2]);
        grid1.hold(begin, std::max(stop - begin, std::min(together_ * half_edge + 1, grid1.corners()[2])));
        grid1.find_weights(opacities(), maps_.matter, 1, device_, begin, stop);
        const BlockMap& needed = grid1.needed();
        for (int z = begin; z < stop; z += block_edge) {
            const int slices = std::min(block_edge, stop - z);
            const auto columns = needed.columns(z, z + slices);
            for_all(columns.size(), [&](std::size_t i) {
                const auto [x, y] = columns[i];
                sweep_block(1, {x * block_edge, y * block_edge, z}, slices,
                            needed.pieces_of_slices(columns[i], z, z + slices));
            });
        }
    }

    void sweep_block(int g, const std::array<int, 3>& first, int slices, const BlockPieces& pieces) {
        CoarseGrid& grid = coarse_[std::size_t(g) - 1];
        kernel::SpaoTile& tile = tile_of_thread();
        kernel::SpaoBlock block = block_on(g, first, tile);
        grid.weigh(first, block);
        load_tile(grid.cells(), first, tile.opacity);
        run_.corners(tile, block, grid.output(first, slices, pieces));
    }

    void sweep_cells(int first, int end) {
        const auto blocks = asked_.held(first, end);
        for_all(blocks.size(), [&](std::size_t i) {
            const auto [x, y, z] = asked_.at(blocks[i]);
            const std::array<int, 3> at{x * block_edge, y * block_edge, z * block_edge};
            kernel::SpaoTile& tile = tile_of_thread();
            const kernel::SpaoBlock block = block_on(0, at, tile);
            load_tile(opacities(), at, tile.opacity);
            run_.cells(tile, block, output_of_cells(rows_of(access_), asked_, blocks[i]));
        });
    }

    kernel::SpaoBlock block_on(int g, const std::array<int, 3>& first, kernel::SpaoTile& tile) const {
        const bool has_coarser = g < int(coarse_.size());
        kernel::SpaoBlock block = spao_block(settings_, true, has_coarser);
        block.tile = &tile;
        if (has_coarser) block.coarse = coarse_[std::size_t(g)].rows_for(first);
        return block;
    }

    /// What the layers from `next` on do not read.
    void discard_before(int next) {
        constexpr int halo = kernel::SpaoTile::halo;
        if (!coarse_.empty()) coarse_[0].discard_cells_before(next * half_edge - halo);
        if (coarse_.size() > 1) coarse_[1].discard_corners_before(next * half_edge / 2);
    }

    const Device& device_;
    const DeviceVolume::Data& volume_;
    const SpaoSettings& settings_;
    const kernel::SpaoFunctions run_;
    StageTimer& steps_;
    Progress& progress_;
    const OpacityMaps maps_;
    const BlockMap asked_;
    const BlockMap every_column_{grid().count, true};
    const int layers_, together_;  ///< of blocks
    const bool keeps_opacity_;
    SliceRing opacity_;
    CellValues access_;
    const SliceWork fill_;
    int filled_ = 0;                  ///< slices
    std::vector<CoarseGrid> coarse_;  ///< of cells twice, four times, ... as wide
};

}  // namespace

CellValues spao_light(const Device& device, const Medium::Data& medium, const SpaoSettings& settings, StageTimer& timer,
                      Progress& progress) {
    LayeredLight light(device, medium, settings, timer, progress);
    return light.run();
}

}  // namespace chiaro
