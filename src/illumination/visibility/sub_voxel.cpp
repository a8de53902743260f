#include "illumination/visibility/sub_voxel.h"

#include <memory>

#include "classify/clip.h"
#include "illumination/visibility/half_way.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// A row of cells among its neighbours, `row` and `slice` apart.
template <class HalfWay, class Value>
void depth_row(const HalfWay& half_way, const Value* at, int row, int slice, int count, float* to) {
    for (int x = 0; x < count; ++x, ++at) {
        const auto here = half_way.from(*at);
        to[x] = (here.to(at[-1]) + here.to(at[1])) + (here.to(at[-row]) + here.to(at[row])) +
                (here.to(at[-slice]) + here.to(at[slice]));
    }
}

using Ranges = std::array<std::pair<int, int>, 3>;

/// Calls visit(x0, x1, y, z) for the pieces of rows that may hold matter.
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
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)) {}

    /// Where cells are voxels.
    template <class HalfWay>
    void fill_from_voxels(const HalfWay& half_way, std::size_t block, float* tile) const {
        const Ranges cells = matter_.cells(block, grid_.count);
        const InTile in{tile, cells};
        for_each_piece(cells, matter_.pieces_of(block), [&](int x, int end, int y, int z) {
            depth_row(half_way, voxels_at(x, y, z), brick_row, brick_slice, end - x, in.at(x, y, z));
            clip_row(x, end, y, z, in.at(x, y, z));
        });
    }

    /// Else from values at the centres of the block's cells and of one more on each side, where asked for.
    template <class HalfWay>
    void fill_between_voxels(const HalfWay& half_way, std::size_t block, float* tile) const {
        const Ranges cells = matter_.cells(block, grid_.count);
        const BlockPieces& pieces = matter_.pieces_of(block);
        const auto [x0, y0, z0] = std::array{cells[0].first, cells[1].first, cells[2].first};
        constexpr int row = block_edge + 2, slice = row * row;
        std::vector<typename HalfWay::Level> levels(std::size_t(row) * slice);
        const auto level = [&, x0 = x0, y0 = y0, z0 = z0](int x, int y, int z) {
            return levels.data() + (z - z0 + 1) * slice + (y - y0 + 1) * row + x - x0 + 1;
        };
        for (int z = z0 - 1; z <= cells[2].second; ++z)
            for (int y = y0 - 1; y <= cells[1].second; ++y) {
                const int asked = pieces_beside(pieces, y - y0, z - z0), middle = x0 + BlockPieces::width;
                const int first = asked & 1 ? x0 - 1 : middle - 1, last = asked & 2 ? cells[0].second : middle;
                for (int x = first; asked && x <= std::min(last, cells[0].second); ++x)
                    *level(x, y, z) = half_way.level_of(value_at(x, y, z));
            }
        const InTile in{tile, cells};
        for_each_piece(cells, pieces, [&](int x, int end, int y, int z) {
            depth_row(half_way, level(x, y, z), row, slice, end - x, in.at(x, y, z));
            clip_row(x, end, y, z, in.at(x, y, z));
        });
    }

private:
    /// A block's row lies in one brick, and its neighbours with it.
    const Voxel* voxels_at(int x, int y, int z) const {
        const kernel::Vec3<float> p{float(x), float(y), float(z)};
        const auto voxel = view_.voxel(p);
        // The last voxel of an axis lies behind its last interval.
        return view_.voxels + std::uint32_t(view_.locate(p, voxel).index) + (x - voxel.x) + (y - voxel.y) * brick_row +
               (z - voxel.z) * brick_slice;
    }
    float value_at(int x, int y, int z) const {
        const Vec3 p = grid_.voxel_of(x, y, z);
        const auto at = view_.clamp(kernel::Vec3<float>(float(p.x), float(p.y), float(p.z)));
        return view_.value(view_.locate(at, view_.voxel(at)));
    }
    /// Which of the two pieces along x a row of the block, or one beside it, belongs to or is a neighbour of.
    static int pieces_beside(const BlockPieces& pieces, int y, int z) {
        const auto bits = [&](int j, int k) {
            const bool inside = j >= 0 && j < block_edge && k >= 0 && k < block_edge;
            return inside ? int(pieces.bits[k / BlockPieces::height][j / BlockPieces::height]) : 0;
        };
        return bits(y, z) | bits(y - 1, z) | bits(y + 1, z) | bits(y, z - 1) | bits(y, z + 1);
    }
    void clip_row(int x0, int x1, int y, int z, float* row) const {
        for (const HalfSpace& half : kept_)
            for (int x = x0; x < x1; ++x)
                if (dot(half.normal, grid_.voxel_of(x, y, z)) > half.d) row[x - x0] = 0;
    }

    const CellGrid& grid_;
    const BlockMap& matter_;
    const kernel::VolumeView<Voxel> view_;
    const std::vector<HalfSpace> kept_;
};

template <class HalfWay, class Voxel, class... Arguments>
FillBlock from_voxels(const std::shared_ptr<const Cells<Voxel>>& cells, Arguments&&... arguments) {
    const auto half_way = std::make_shared<const HalfWay>(std::forward<Arguments>(arguments)...);
    return [=](std::size_t block, float* tile) { cells->fill_from_voxels(*half_way, block, tile); };
}
template <class HalfWay, class Voxel, class... Arguments>
FillBlock between_voxels(const std::shared_ptr<const Cells<Voxel>>& cells, Arguments&&... arguments) {
    const auto half_way = std::make_shared<const HalfWay>(std::forward<Arguments>(arguments)...);
    return [=](std::size_t block, float* tile) { cells->fill_between_voxels(*half_way, block, tile); };
}

/// Levels a unit of stored whole numbers that are interpolated: as fine as single precision is there.
int levels_per_unit(const DeviceVolume::Data& volume) {
    const double units = std::max(1.0, double(volume.stored_max) - volume.stored_min);
    return int(std::clamp(32768 / units, 1.0, 16.0));
}

}  // namespace

FillBlock block_depths(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const ExtinctionIntegral integral(medium, grid);
    return with_stored_voxel(volume, [&](auto voxel) -> FillBlock {
        using Voxel = decltype(voxel);
        const auto cells = std::make_shared<const Cells<Voxel>>(medium, grid, matter);
        if constexpr (sizeof(Voxel) <= 2) {
            if (grid.is_voxel_grid) return from_voxels<HalfWayOfVoxels<Voxel>>(cells, integral, volume);
            return between_voxels<HalfWayOfLevels>(cells, integral, volume, levels_per_unit(volume));
        } else {
            if (grid.is_voxel_grid) return from_voxels<HalfWayOfAny>(cells, integral);
            return between_voxels<HalfWayOfAny>(cells, integral);
        }
    });
}

FillBlock block_depths(const CellOpacity& opacity) {
    std::vector<float> depth_of;
    for (int v = 0; v <= int(cell_one); ++v)
        depth_of.push_back(float(-std::log1p(-std::min(v / double(cell_one), 1 - 1e-7))));
    return [depth_of = std::move(depth_of), &opacity](std::size_t block, float* tile) {
        const CellGrid& grid = opacity.values.grid;
        const auto [x, y, z] = opacity.matter.cells(block, grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j) {
                const std::uint16_t* from = opacity.values.data() + grid.index(x.first, j, k);
                float* to = tile + ((k - z.first) * block_edge + j - y.first) * block_edge;
                for (int i = 0; i < x.second - x.first; ++i) to[i] = depth_of[from[i]];
            }
    };
}

}  // namespace chiaro
