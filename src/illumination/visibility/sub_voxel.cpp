#include "illumination/visibility/sub_voxel.h"

#include <algorithm>
#include <memory>

#include "cuda/device_cache.h"
#include "illumination/cells/launch_rows.h"
#include "illumination/visibility/density.h"
#include "illumination/visibility/launch_gpu.h"
#include "illumination/visibility/sub_voxel_integral.h"
#include "volume/device_view.h"
#include "volume/label_view.h"

namespace chiaro {
namespace {

/// A row of cells among its neighbours, `row` and `slice` apart.
template <class SubVoxelIntegral, class Value>
void depth_row(const SubVoxelIntegral& sub_voxel, const Value* at, int row, int slice, int count, float* to) {
    for (int x = 0; x < count; ++x) to[x] = kernel::depth_among(sub_voxel, at + x, row, slice);
}

using Ranges = std::array<std::pair<int, int>, 3>;

/// Calls visit(x0, x1, y, z) for the pieces of rows that may are occupied.
template <class Visit>
void for_each_piece(const Ranges& cells, const BlockPieces& pieces, const Visit& visit) {
    const auto [x, y, z] = cells;
    for (int k = z.first; k < z.second; ++k)
        for (int j = y.first; j < y.second; ++j)
            for (int i = x.first; i < x.second; i += BlockPieces::width)
                if (pieces.bits[(k - z.first) / BlockPieces::height][(j - y.first) / BlockPieces::height] >>
                        ((i - x.first) / BlockPieces::width) &
                    1)
                    visit(i, std::min(i + BlockPieces::width, x.second), j, k);
}

/// Where the cells of a block lie in its tile.
struct InTile {
    float* tile;
    const Ranges& cells;
    float* at(int x, int y, int z) const {
        return tile + ((z - cells[2].first) * block_edge + y - cells[1].first) * block_edge + x - cells[0].first;
    }
};

template <class Voxel>
class Cells {
public:
    Cells(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter)
        : grid_(grid),
          matter_(matter),
          view_(view_of<Voxel>(medium.volume.data())),
          centres_(cell_centres(medium, grid)),
          run_(kernel::cell_functions_for(medium.volume.data().device.isa)) {}

    const CellGrid& grid() const { return grid_; }
    const kernel::VolumeView<Voxel>& view() const { return view_; }
    const kernel::CellCentres& centres() const { return centres_; }

    /// Where cells are voxels: a block's row lies in one brick, and its neighbours with it.
    template <class SubVoxelIntegral>
    void fill_from_voxels(const SubVoxelIntegral& sub_voxel, std::size_t block, float* tile) const {
        const Ranges cells = matter_.cells(block, grid_.count);
        const InTile in{tile, cells};
        for_each_piece(cells, matter_.pieces_of(block), [&](int x, int end, int y, int z) {
            depth_row(sub_voxel, voxel_address(view_, x, y, z), brick_row, brick_slice, end - x, in.at(x, y, z));
            dim_row(x, end, y, z, in.at(x, y, z));
            clip_row(x, end, y, z, in.at(x, y, z));
        });
    }

    /// Else from values at the centres of the block's cells and of one more on each side, where asked for.
    template <class SubVoxelIntegral>
    void fill_between_voxels(const SubVoxelIntegral& sub_voxel, std::size_t block, float* tile) const {
        const Ranges cells = matter_.cells(block, grid_.count);
        const BlockPieces& pieces = matter_.pieces_of(block);
        const auto [x0, y0, z0] = std::array{cells[0].first, cells[1].first, cells[2].first};
        constexpr int row = block_edge + 2, slice = row * row;
        std::vector<typename SubVoxelIntegral::Level> levels(std::size_t(row) * slice);
        const auto level = [&, x0 = x0, y0 = y0, z0 = z0](int x, int y, int z) {
            return levels.data() + (z - z0 + 1) * slice + (y - y0 + 1) * row + x - x0 + 1;
        };
        constexpr int whole = (row + 15) / 16 * 16;
        float places[row + 16], values[whole];
        for (int i = 0; i < row + 16; ++i) places[i] = float(centres_.along(0, x0 - 1 + i));
        for (int z = z0 - 1; z <= cells[2].second; ++z)
            for (int y = y0 - 1; y <= cells[1].second; ++y) {
                const int asked = pieces_beside(pieces, y - y0, z - z0), middle = x0 + BlockPieces::width;
                if (!asked) continue;
                const int first = asked & 1 ? x0 - 1 : middle - 1,
                          last = std::min(asked & 2 ? cells[0].second : middle, cells[0].second);
                run_.find_values(view_, {places + (first - x0 + 1), float(centres_.along(1, y)),
                                         float(centres_.along(2, z)), last - first + 1, values});
                for (int x = first; x <= last; ++x) *level(x, y, z) = sub_voxel.level_of(values[x - first]);
            }
        const InTile in{tile, cells};
        for_each_piece(cells, pieces, [&](int x, int end, int y, int z) {
            depth_row(sub_voxel, level(x, y, z), row, slice, end - x, in.at(x, y, z));
            dim_row(x, end, y, z, in.at(x, y, z));
            clip_row(x, end, y, z, in.at(x, y, z));
        });
    }

private:
    /// Which of the two pieces along x a row of the block, or one beside it, belongs to or is a neighbour of.
    static int pieces_beside(const BlockPieces& pieces, int y, int z) {
        const auto bits = [&](int j, int k) {
            const bool inside = j >= 0 && j < block_edge && k >= 0 && k < block_edge;
            return inside ? int(pieces.bits[k / BlockPieces::height][j / BlockPieces::height]) : 0;
        };
        return bits(y, z) | bits(y - 1, z) | bits(y + 1, z) | bits(y, z - 1) | bits(y, z + 1);
    }
    void dim_row(int x0, int x1, int y, int z, float* row) const {
        for (int x = x0; view_.has_factor() && x < x1; ++x)
            if (row[x - x0] > 0) row[x - x0] *= kernel::factor_of_cell(view_, centres_, x, y, z);
    }
    void clip_row(int x0, int x1, int y, int z, float* row) const {
        for (int x = x0; centres_.plane_count > 0 && x < x1; ++x)
            if (centres_.is_clipped(x, y, z)) row[x - x0] = 0;
    }

    const CellGrid& grid_;
    const BlockMap& matter_;
    const kernel::VolumeView<Voxel> view_;
    const kernel::CellCentres centres_;
    const kernel::RowFunctions<Voxel> run_;
};

/// With pointers of the GPU's into `arrays`; `swap_pointers(views, depth)` names them.
template <class Depth, class SwapPointers>
FillBlocks on_gpu(cuda::Stream& stream, HostArrays arrays, const CellGrid& grid, Depth depth,
                  const SwapPointers& swap_pointers) {
    const auto views = std::make_shared<cuda::Views>(stream, std::move(arrays));
    swap_pointers(*views, depth);
    const auto [nx, ny, nz] = grid.count;
    return [views, &stream, fill = kernel::FillTiles<Depth>{depth, {nx, ny, nz}, nullptr, nullptr}](
               const kernel::BlockPlace* places, std::int64_t blocks, float* tiles) mutable {
        fill.places = places, fill.tiles = tiles;
        kernel::run_on_gpu(stream, blocks * tile_size, fill);
    };
}

void swap_pointers(cuda::Views& views, kernel::SubVoxelIntegralOfAny& sub_voxel) {
    views.to_device_pointers(sub_voxel.integral.extinction, sub_voxel.integral.before);
}
void swap_pointers(cuda::Views& views, kernel::SubVoxelIntegralOfLevels& sub_voxel) {
    views.to_device_pointers(sub_voxel.integral, sub_voxel.inverse, sub_voxel.sixth);
}
template <class Voxel>
void swap_pointers(cuda::Views& views, kernel::SubVoxelIntegralOfVoxels<Voxel>& sub_voxel) {
    swap_pointers(views, sub_voxel.levels);
}
void swap_pointers(cuda::Views& views, kernel::SubVoxelIntegralOfVoxels<std::uint8_t>& sub_voxel) {
    views.to_device_pointers(sub_voxel.pairs);
}

/// `Depth`: as a GPU finds it.
template <template <class, class> class Depth, class Voxel, class Tables>
std::function<FillBlocks(cuda::Stream&)> depths_on_gpu(const DeviceVolume::Data& volume,
                                                       const std::shared_ptr<const Cells<Voxel>>& cells,
                                                       const std::shared_ptr<const Tables>& tables) {
    return [&volume, cells, tables](cuda::Stream& stream) {
        HostArrays arrays;
        volume.add_to(arrays), tables->add_to(arrays);
        auto sub_voxel = tables->view();
        const Depth<Voxel, decltype(sub_voxel)> depth{cells->view(), cells->centres(), sub_voxel};
        return on_gpu(stream, std::move(arrays), cells->grid(), depth, [](cuda::Views& views, auto& of) {
            swap_pointers(views, of.volume);
            swap_pointers(views, of.sub_voxel);
        });
    };
}

template <class Voxel, class Tables>
BlockDepths from_voxels(const DeviceVolume::Data& volume, const std::shared_ptr<const Cells<Voxel>>& cells,
                        const std::shared_ptr<const Tables>& tables) {
    return {[=](std::size_t block, float* tile) { cells->fill_from_voxels(tables->view(), block, tile); },
            depths_on_gpu<kernel::DepthOfVoxels>(volume, cells, tables)};
}
template <class Voxel, class Tables>
BlockDepths between_voxels(const DeviceVolume::Data& volume, const std::shared_ptr<const Cells<Voxel>>& cells,
                           const std::shared_ptr<const Tables>& tables) {
    return {[=](std::size_t block, float* tile) { cells->fill_between_voxels(tables->view(), block, tile); },
            depths_on_gpu<kernel::DepthBetweenVoxels>(volume, cells, tables)};
}

/// Levels a unit of stored whole numbers that are interpolated: as fine as single precision is there.
int levels_per_unit(const DeviceVolume::Data& volume) {
    const double units = std::max(1.0, double(volume.stored_max) - volume.stored_min);
    return int(std::clamp(32768 / units, 1.0, 16.0));
}

}  // namespace

/// What labels leave of the depths of a block's cells, by their middles.
FillBlock left_by_labels(const kernel::LabelView& labels, const Medium::Data& medium, const CellGrid& grid,
                         const BlockMap& matter) {
    const DeviceVolume::Data& volume = medium.volume.data();
    if (!labels.distance && !labels.share) return {};
    const auto view = view_of<std::uint8_t>(volume);  // of places alone
    return [=, &grid, &matter, centres = cell_centres(medium, grid)](std::size_t block, float* tile) {
        const auto [x, y, z] = matter.cells(block, grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j) {
                float* const row = tile + ((k - z.first) * block_edge + j - y.first) * block_edge;
                for (int i = x.first; i < x.second; ++i) {
                    if (!(row[i - x.first] > 0)) continue;
                    const auto p = view.clamp(centres.of(i, j, k));
                    row[i - x.first] *= kernel::left_of<float>(labels, view.locate(p, view.voxel(p)));
                }
            }
    };
}

/// Extinctions add.
BlockDepths depths_of_channels(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter) {
    std::vector<FillBlock> channels;
    for_each_channel(medium, [&](const Medium::Data& channel) {
        channels.push_back(block_depths(channel, grid, matter).here);
        if (!channel.share) return;
        const auto* share = reinterpret_cast<const std::uint8_t*>(channel.share->data());
        const auto left = left_by_labels({nullptr, share, nullptr}, medium, grid, matter);
        channels.back() = [whole = channels.back(), left](std::size_t block, float* tile) {
            whole(block, tile);
            left(block, tile);
        };
    });
    const kernel::LabelView labels = label_view(medium.volume.data().mixture->labels.get());
    const auto here = [channels, left = left_by_labels(labels, medium, grid, matter)](std::size_t block, float* tile) {
        std::vector<float> one(tile_size);
        for (const FillBlock& fill : channels) {
            std::fill(one.begin(), one.end(), 0.0f);
            fill(block, one.data());
            for (std::size_t i = 0; i < one.size(); ++i) tile[i] += one[i];
        }
        if (left) left(block, tile);
    };
    return {here, {}};
}

BlockDepths block_depths(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter) {
    if (is_mixed(medium)) return depths_of_channels(medium, grid, matter);
    const DeviceVolume::Data& volume = medium.volume.data();
    const auto integral = std::make_shared<const ExtinctionIntegral>(medium, grid);
    return with_stored_voxel(volume, [&](auto voxel) {
        using Voxel = decltype(voxel);
        const auto cells = std::make_shared<const Cells<Voxel>>(medium, grid, matter);
        if constexpr (sizeof(Voxel) <= 2) {
            if (grid.is_voxel_grid)
                return from_voxels(volume, cells, std::make_shared<const VoxelIntegrals<Voxel>>(*integral, volume));
            return between_voxels(volume, cells,
                                  std::make_shared<const LevelIntegrals>(*integral, volume, levels_per_unit(volume)));
        } else {
            return grid.is_voxel_grid ? from_voxels(volume, cells, integral) : between_voxels(volume, cells, integral);
        }
    });
}

BlockDepths block_depths(const CellOpacity& opacity) {
    std::vector<float> depths;
    for (int v = 0; v <= int(cell_one); ++v)
        depths.push_back(float(-std::log1p(-std::min(v / double(cell_one), 1 - 1e-7))));
    const auto depth_of = std::make_shared<const std::vector<float>>(std::move(depths));
    const auto here = [depth_of, &opacity](std::size_t block, float* tile) {
        const CellGrid& grid = opacity.values.grid;
        const auto [x, y, z] = opacity.matter.cells(block, grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j) {
                const std::uint16_t* from = opacity.values.data() + grid.index(x.first, j, k);
                float* to = tile + ((k - z.first) * block_edge + j - y.first) * block_edge;
                for (int i = 0; i < x.second - x.first; ++i) to[i] = (*depth_of)[from[i]];
            }
    };
    const auto there = [depth_of, &opacity](cuda::Stream& stream) {
        const CellGrid& grid = opacity.values.grid;
        HostArrays arrays;
        arrays.add(*depth_of);
        const kernel::DepthOfOpacity depth{opacity.values.on_gpu(stream), depth_of->data(), grid.count[0],
                                           grid.count[1]};
        return on_gpu(stream, std::move(arrays), grid, depth,
                      [](cuda::Views& views, auto& of) { views.to_device_pointers(of.depth_of); });
    };
    return {here, there};
}

BlockDepths block_depths(const Density& density, const BlockMap& all) {
    const auto here = [&](std::size_t block, float* tile) {
        const auto [x, y, z] = all.cells(block, density.grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                std::copy_n(density.data() + density.grid.index(x.first, j, k), x.second - x.first,
                            tile + ((k - z.first) * block_edge + j - y.first) * block_edge);
    };
    const auto there = [&](cuda::Stream& stream) {
        const kernel::DepthOfNodes depth{density.on_gpu(stream), density.grid.count[0], density.grid.count[1]};
        return on_gpu(stream, {}, density.grid, depth, [](cuda::Views&, auto&) {});
    };
    return {here, there};
}

}  // namespace chiaro
