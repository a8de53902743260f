#include "illumination/visibility/sub_voxel.h"

#include <memory>

#include "classify/clip.h"
#include "illumination/visibility/integral.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// A sixth of the mean of κ from a value half way to a neighbour's: six of them are a cell's κ.
/// Of 8-bit values all pairs are in a table.
template <class Value>
class HalfWay {
public:
    explicit HalfWay(const ExtinctionIntegral& integral, const DeviceVolume::Data&) : integral_(integral) {}

    struct From {
        const ExtinctionIntegral& integral;
        ExtinctionIntegral::Place place;
        double value;
        float to(Value neighbour) const {
            if (double(neighbour) == value) return integral.mean(place, place) * (1.0f / 6);
            return integral.mean(place, integral.place(0.5 * (value + double(neighbour)))) * (1.0f / 6);
        }
    };
    From from(Value value) const { return {integral_, integral_.place(double(value)), double(value)}; }

private:
    ExtinctionIntegral integral_;
};

template <>
class HalfWay<std::uint8_t> {
public:
    HalfWay(const ExtinctionIntegral& integral, const DeviceVolume::Data& volume) : table_(256 * 256) {
        const HalfWay<float> mean(integral, volume);
        for (int value = int(volume.stored_min); value <= int(volume.stored_max); ++value)
            for (int other = int(volume.stored_min); other <= int(volume.stored_max); ++other)
                table_[std::size_t(256 * value + other)] = mean.from(float(value)).to(float(other));
    }

    struct From {
        const float* row;
        float to(std::uint8_t neighbour) const { return row[neighbour]; }
    };
    From from(std::uint8_t value) const { return {table_.data() + 256 * std::size_t(value)}; }

private:
    std::vector<float> table_;
};

/// A row of cells among its neighbours, `row` and `slice` apart.
template <class Value>
void depth_row(const HalfWay<Value>& half_way, const Value* at, int row, int slice, int count, float* to) {
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

template <class Voxel>
class BlockDepths {
public:
    BlockDepths(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter)
        : grid_(grid),
          matter_(matter),
          view_(view_of<Voxel>(medium.volume.data())),
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)),
          integral_(medium, grid_),
          of_voxels_(integral_, medium.volume.data()),
          of_values_(integral_, medium.volume.data()) {}

    void operator()(std::size_t block, float* tile) const {
        const Ranges cells = matter_.cells(block, grid_.count);
        const BlockPieces& pieces = matter_.pieces_of(block);
        const auto [x, y, z] = cells;
        const auto at = [&, x = x, y = y, z = z](int i, int j, int k) {
            return tile + ((k - z.first) * block_edge + j - y.first) * block_edge + i - x.first;
        };
        if (grid_.is_voxel_grid)
            for_each_piece(cells, pieces, [&](int i, int end, int j, int k) {
                depth_row(of_voxels_, voxels_at(i, j, k), brick_row, brick_slice, end - i, at(i, j, k));
            });
        else
            fill_between_voxels(cells, pieces, at);
        if (!kept_.empty())
            for_each_piece(cells, pieces, [&](int i, int end, int j, int k) { clip_row(i, end, j, k, at(i, j, k)); });
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

    /// Cells that are no voxels: values at the centres of the block's cells and of one more on each side.
    template <class At>
    void fill_between_voxels(const Ranges& cells, const BlockPieces& pieces, const At& at) const {
        constexpr int row = block_edge + 2, slice = row * row;
        std::vector<float> values(std::size_t(row) * slice);
        const auto [x, y, z] = cells;
        for (int k = z.first - 1; k <= z.second; ++k)
            for (int j = y.first - 1; j <= y.second; ++j)
                for (int i = x.first - 1; i <= x.second; ++i)
                    values[std::size_t((k - z.first + 1) * slice + (j - y.first + 1) * row + i - x.first + 1)] =
                        value_at(i, j, k);
        for_each_piece(cells, pieces, [&, x = x, y = y, z = z](int i, int end, int j, int k) {
            const float* centre = values.data() + (k - z.first + 1) * slice + (j - y.first + 1) * row + i - x.first + 1;
            depth_row(of_values_, centre, row, slice, end - i, at(i, j, k));
        });
    }
    float value_at(int x, int y, int z) const {
        const Vec3 p = grid_.voxel_of(x, y, z);
        const auto at = view_.clamp(kernel::Vec3<float>(float(p.x), float(p.y), float(p.z)));
        return view_.value(view_.locate(at, view_.voxel(at)));
    }

    void clip_row(int x0, int x1, int y, int z, float* row) const {
        for (int x = x0; x < x1; ++x)
            for (const HalfSpace& half : kept_)
                if (dot(half.normal, grid_.voxel_of(x, y, z)) > half.d) row[x - x0] = 0;
    }

    const CellGrid& grid_;
    const BlockMap& matter_;
    const kernel::VolumeView<Voxel> view_;
    const std::vector<HalfSpace> kept_;
    const ExtinctionIntegral integral_;
    const HalfWay<Voxel> of_voxels_;
    const HalfWay<float> of_values_;
};

}  // namespace

FillBlock block_depths(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter) {
    return with_stored_voxel(medium.volume.data(), [&](auto voxel) -> FillBlock {
        const auto depths = std::make_shared<BlockDepths<decltype(voxel)>>(medium, grid, matter);
        return [depths](std::size_t block, float* tile) { (*depths)(block, tile); };
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
