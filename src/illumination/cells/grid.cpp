#include "illumination/cells/grid.h"

#include "classify/clip.h"
#include "classify/medium.h"
#include "core/threads.h"

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

constexpr double max_resampled = 1 << 28;  ///< cells; about 6 bytes are needed for each

CellGrid cells_of_edge(double edge_mm, const std::array<int, 3>& dimensions, const Geometry& geometry) {
    CellGrid grid;
    grid.edge_mm = edge_mm;
    for (int axis = 0; axis < 3; ++axis) {
        const int n = dimensions[axis];
        double stretch = geometry.spacing_mm[axis] / edge_mm;
        if (std::abs(stretch - 1) * n < 0.05) stretch = 1;  // less than rounding in a header
        grid.is_voxel_grid = grid.is_voxel_grid && stretch == 1;
        grid.voxels_per_cell[axis] = 1 / stretch;
        grid.count[axis] = int(std::clamp(std::ceil(n * stretch - 0.01), 1.0, 2e9));
    }
    return grid;
}

}  // namespace

kernel::GridView view_of(const CellGrid& grid) {
    const auto [nx, ny, nz] = grid.count;
    const auto last = [](int n) { return std::max(n - 2, 0); };
    const auto scale = [&](int axis) { return float(1 / grid.voxels_per_cell[axis]); };
    // voxel = (cell + ½) k - ½, the other way round
    const auto shift = [&](int axis) { return float(0.5 / grid.voxels_per_cell[axis] - 0.5); };
    return {
        .row = ny > 1 ? nx : 0,
        .slice = nz > 1 ? nx * ny : 0,
        .last = {float(nx - 1), float(ny - 1), float(nz - 1)},
        .last_x = last(nx),
        .last_y = last(ny),
        .last_z = last(nz),
        .nodes_per_voxel = {scale(0), scale(1), scale(2)},
        .shift = {shift(0), shift(1), shift(2)},
    };
}

Geometry geometry_of(const CellGrid& cells, const Geometry& voxels) {
    Geometry geometry = voxels;
    geometry.origin_mm = voxels.world_from_voxel(cells.voxel_of(0, 0, 0));
    for (int axis = 0; axis < 3; ++axis) geometry.spacing_mm[axis] *= cells.voxels_per_cell[axis];
    return geometry;
}

kernel::CellCentres cell_centres(const CellGrid& grid) {
    const Vec3& step = grid.voxels_per_cell;
    return {
        .voxels_per_cell = {step.x, step.y, step.z}, .planes = {}, .plane_count = 0, .are_voxels = grid.is_voxel_grid};
}

kernel::CellCentres cell_centres(const Medium::Data& medium, const CellGrid& grid) {
    static_assert(6 + max_clip_planes <= kernel::CellCentres::max_planes);
    const DeviceVolume::Data& volume = medium.volume.data();
    kernel::CellCentres centres = cell_centres(grid);
    for (const HalfSpace& kept : half_spaces(medium.shape.clip, volume.geometry, volume.dimensions))
        centres.planes[centres.plane_count++] = {kept.normal.x, kept.normal.y, kept.normal.z, kept.d};
    return centres;
}

CellGrid make_cell_grid(const std::array<int, 3>& dimensions, const Geometry& geometry) {
    const double voxels = double(dimensions[0]) * dimensions[1] * dimensions[2];
    // Very thick slices would make very many cells: then these are wider.
    const double most = std::max(voxels, std::min(64 * voxels, max_resampled));
    for (double edge = geometry.smallest_spacing_mm();; edge *= 1.25) {
        const CellGrid grid = cells_of_edge(edge, dimensions, geometry);
        if (double(grid.count[0]) * grid.count[1] * grid.count[2] <= most) return grid;
    }
}

CellGrid coarser(const CellGrid& grid, int factor) {
    CellGrid coarse = grid;
    if (factor == 1) return coarse;
    coarse.edge_mm = factor * grid.edge_mm;
    coarse.is_voxel_grid = false;
    for (int axis = 0; axis < 3; ++axis) {
        coarse.count[axis] = (grid.count[axis] + factor - 1) / factor;
        coarse.voxels_per_cell[axis] = factor * grid.voxels_per_cell[axis];
    }
    return coarse;
}

std::array<std::pair<int, int>, 3> BlockMap::cells(std::size_t block, const std::array<int, 3>& grid) const {
    const auto b = at(block);
    std::array<std::pair<int, int>, 3> ranges;
    for (int axis = 0; axis < 3; ++axis)
        ranges[axis] = {b[axis] * block_edge, std::min((b[axis] + 1) * block_edge, grid[axis])};
    return ranges;
}

BlockPieces BlockMap::pieces_of_slices(std::array<int, 2> column, int first, int end) const {
    constexpr int height = BlockPieces::height;
    BlockPieces found{};
    for (int z = first; z < end; z += height) {
        const std::size_t block = index(column[0], column[1], z / block_edge);
        if (holds[block])
            std::copy_n(pieces_of(block).bits[z % block_edge / height], block_edge / height,
                        found.bits[(z - first) / height]);
    }
    return found;
}

std::vector<std::size_t> BlockMap::held() const { return held(0, count[2]); }

std::vector<std::size_t> BlockMap::held(int first_layer, int end_layer) const {
    const std::size_t layer = std::size_t(count[0]) * count[1];
    std::vector<std::size_t> list;
    for (std::size_t b = std::size_t(first_layer) * layer; b < std::size_t(end_layer) * layer; ++b)
        if (holds[b]) list.push_back(b);
    return list;
}

std::vector<std::array<int, 2>> BlockMap::columns(int first, int end) const {
    std::vector<std::array<int, 2>> list;
    for (int y = 0; y < count[1]; ++y)
        for (int x = 0; x < count[0]; ++x) {
            bool any = false;
            for (int z = first / block_edge; z * block_edge < end; ++z) any = any || at(x, y, z);
            if (any) list.push_back({x, y});
        }
    return list;
}

BlockMap visible_blocks(const Medium::Data& medium, const CellGrid& grid, double reach) {
    const Occupied occupied(medium, grid, reach);
    BlockMap map(grid.count);
    map.pieces.resize(map.holds.size());
    constexpr int width = BlockPieces::width, height = BlockPieces::height, pieces = block_edge / height;
    const auto find = [&](std::size_t b) {
        const auto block = map.at(b);
        const auto range = [&](int axis, int from, int size) {
            return occupied.along(axis, block[axis] * block_edge + from, block[axis] * block_edge + from + size);
        };
        map.holds[b] =
            any_occupied(medium, {range(0, 0, block_edge), range(1, 0, block_edge), range(2, 0, block_edge)});
        for (int z = 0; map.holds[b] && z < pieces; ++z)
            for (int y = 0; y < pieces; ++y)
                for (int x = 0; x < block_edge / width; ++x)
                    map.pieces[b].bits[z][y] |=
                        any_occupied(medium, {range(0, x * width, width), range(1, y * height, height),
                                              range(2, z * height, height)})
                        << x;
    };
    parallel_for(medium.volume.data().device.threads, std::int64_t(map.holds.size()), 16,
                 [&](std::int64_t first, std::int64_t end) {
                     for (auto b = first; b < end; ++b) find(std::size_t(b));
                 });
    return map;
}

}  // namespace chiaro
