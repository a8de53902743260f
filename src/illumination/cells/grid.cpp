#include "illumination/cells/grid.h"

#include <chiaro/error.h>

#include "classify/medium.h"

namespace chiaro {
namespace {

using Range = std::pair<int, int>;
using Ranges = std::array<Range, 3>;

/// Whether any 4³ cell of the occupancy within the ranges (both ends included) is occupied.
bool any_occupied(const Medium::Data& medium, const Ranges& cells) {
    const auto& count = medium.volume.data().cells.count;
    for (int z = cells[2].first; z <= cells[2].second; ++z)
        for (int y = cells[1].first; y <= cells[1].second; ++y) {
            const std::uint8_t* row = &medium.cells[(std::size_t(z) * count[1] + y) * count[0]];
            for (int x = cells[0].first; x <= cells[0].second; ++x)
                if (row[x] & 1) return true;
        }
    return false;
}

/// Cells [first, end) along one axis and `reach` around them, as 4³ cells of the occupancy.
class Occupied {
public:
    Occupied(const Medium::Data& medium, const CellGrid& grid, double reach)
        : medium_(medium), grid_(grid), reach_(reach) {}
    Range along(int axis, int first, int end) const {
        const double k = grid_.voxels_per_cell[axis];
        const int last = medium_.volume.data().cells.count[axis] - 1;
        const int low = int(std::floor((first + 0.5 - reach_) * k - 0.5)),
                  high = int(std::ceil((end - 0.5 + reach_) * k - 0.5));
        return {std::clamp(low >> cell_bits, 0, last), std::clamp(high >> cell_bits, 0, last)};
    }

private:
    const Medium::Data& medium_;
    const CellGrid& grid_;
    double reach_;
};

}  // namespace

CellGrid make_cell_grid(const std::array<int, 3>& dimensions, const Geometry& geometry) {
    CellGrid grid;
    grid.edge_mm = geometry.smallest_spacing_mm();
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const int n = dimensions[axis];
        double stretch = geometry.spacing_mm[axis] / grid.edge_mm;
        if (std::abs(stretch - 1) * n < 0.05) stretch = 1;  // less than rounding in a header
        grid.is_voxel_grid = grid.is_voxel_grid && stretch == 1;
        grid.voxels_per_cell[axis] = 1 / stretch;
        const double count = std::ceil(n * stretch - 0.01);
        cells *= count;
        if (cells > 2147483647.0)
            throw Error(ErrorCode::output,
                        "light on cells of the smallest spacing would need more than 2147483647 of them: resample the "
                        "volume, or use --lighting none");
        grid.count[axis] = int(count);
    }
    return grid;
}

std::array<std::pair<int, int>, 3> BlockMap::cells(std::size_t block, const std::array<int, 3>& grid) const {
    const auto b = at(block);
    std::array<std::pair<int, int>, 3> ranges;
    for (int axis = 0; axis < 3; ++axis)
        ranges[axis] = {b[axis] * block_edge, std::min((b[axis] + 1) * block_edge, grid[axis])};
    return ranges;
}

std::vector<std::size_t> BlockMap::held() const {
    std::vector<std::size_t> list;
    for (std::size_t b = 0; b < holds.size(); ++b)
        if (holds[b]) list.push_back(b);
    return list;
}

BlockMap visible_blocks(const Medium::Data& medium, const CellGrid& grid, double reach) {
    const Occupied occupied(medium, grid, reach);
    BlockMap map(grid.count);
    map.pieces.resize(map.holds.size());
    constexpr int width = BlockPieces::width, height = BlockPieces::height, pieces = block_edge / height;
    for (std::size_t b = 0; b < map.holds.size(); ++b) {
        const auto block = map.at(b);
        const auto range = [&](int axis, int from, int size) {
            return occupied.along(axis, block[axis] * block_edge + from, block[axis] * block_edge + from + size);
        };
        map.pieces[b] = {};
        map.holds[b] =
            any_occupied(medium, {range(0, 0, block_edge), range(1, 0, block_edge), range(2, 0, block_edge)});
        for (int z = 0; map.holds[b] && z < pieces; ++z)
            for (int y = 0; y < pieces; ++y)
                for (int x = 0; x < block_edge / width; ++x)
                    map.pieces[b].bits[z][y] |=
                        any_occupied(medium, {range(0, x * width, width), range(1, y * height, height),
                                              range(2, z * height, height)})
                        << x;
    }
    return map;
}

}  // namespace chiaro
