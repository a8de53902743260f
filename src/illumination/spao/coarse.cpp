#include "illumination/spao/coarse.h"

#include <algorithm>

namespace chiaro {
namespace {

constexpr int half_block = block_edge / 2;

/// Cells [first, end) of a row from four finer rows; beyond the finer rows' end lies nothing.
template <class ShrinkRow>
void shrink_row(ShrinkRow run, kernel::MipRows rows, int first, int end, int finer_end, std::uint16_t* to) {
    for (auto& from : rows.from) from += 2 * first;
    const int whole = std::min(end, finer_end / 2) - first;
    run(rows, whole, to + first);
    if (first + whole == end) return;
    std::uint16_t last[4][2] = {};  // the last cell has no partner
    for (int r = 0; r < 4; ++r) last[r][0] = rows.from[r][2 * whole];
    run({{last[0], last[1], last[2], last[3]}}, 1, to + end - 1);
}

}  // namespace

CoarseShape::CoarseShape(const std::array<int, 3>& finer) {
    for (int axis = 0; axis < 3; ++axis) {
        count[axis] = (finer[axis] + 1) / 2;
        corners[axis] = (count[axis] / block_edge + 1) * block_edge;
    }
}

BlockMap CoarseShape::needed_by(const BlockMap& finer) const {
    BlockMap needed(corners);
    for (const std::size_t b : finer.held()) {
        const auto at = finer.at(b);
        std::array<int, 3> low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(at[axis] / 2, needed.count[axis] - 1);
            high[axis] = std::min((at[axis] * half_block + half_block) / block_edge, needed.count[axis] - 1);
        }
        for (int z = low[2]; z <= high[2]; ++z)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int x = low[0]; x <= high[0]; ++x) needed(x, y, z) = 1;
    }
    return needed;
}

CoarseGrid::CoarseGrid(const CellOpacity& finest, int octants, const Device& device, Progress& progress)
    : octants_(octants), shape_(finest.values.grid.count) {
    const kernel::OpacityGrid grid = opacity_grid(finest.values.grid.count, finest.values.data());
    allocate();
    shrink(grid, &finest.matter, device, progress);
    if (octants_ > 1) find_weights(grid, finest.matter, device, progress);
}

CoarseGrid::CoarseGrid(const CoarseGrid& finer, const Device& device, Progress& progress)
    : octants_(finer.octants_), shape_(finer.shape_.count) {
    allocate();
    shrink(finer.opacity(), nullptr, device, progress);
    if (octants_ == 1) return;
    const auto [nx, ny, nz] = finer.shape_.corners;
    const kernel::EveryOther weights{as_shorts(finer.weight_), {nx, ny, nz}};
    for (int z = 0; z < shape_.corners[2]; ++z)
        for (int y = 0; y < shape_.corners[1]; ++y)
            for (int x = 0; x < shape_.corners[0]; ++x) as_shorts(weight_)[corner({x, y, z})] = weights.at(x, y, z);
}

void CoarseGrid::allocate() {
    opacity_ = VoxelBuffer(shape_.cells_held() * sizeof(std::uint16_t));
    open_ = VoxelBuffer(shape_.corners_held() * octants_ * sizeof(std::uint16_t));
    if (octants_ > 1) weight_ = VoxelBuffer(shape_.corners_held() * sizeof(std::uint16_t));
}

/// `matter` tells which blocks of the finer grid may hold something else than 0; null: all may.
void CoarseGrid::shrink(const kernel::OpacityGrid& finer, const BlockMap* matter, const Device& device,
                        Progress& progress) {
    const auto functions = kernel::spao_functions_for(device.isa);
    const auto run = octants_ > 1 ? functions.crossing_row : functions.mip_row;
    const std::vector<std::uint16_t> zeros(finer.count[0]);
    const auto [nx, ny, nz] = shape_.count;
    const auto slice = [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        for (int y = 0; y < ny; ++y) {
            kernel::MipRows rows;
            for (int r = 0; r < 4; ++r) {
                const int j = 2 * y + (r & 1), k = 2 * int(z) + (r >> 1);
                rows.from[r] = j < finer.count[1] && k < finer.count[2] ? finer.row(j, k) : zeros.data();
            }
            std::uint16_t* to = as_shorts(opacity_) + (std::size_t(z) * ny + y) * nx;
            for (int x = 0; x < nx; x += half_block)
                if (!matter || matter->at(x / half_block, y / half_block, int(z) / half_block))
                    shrink_row(run, rows, x, std::min(x + half_block, nx), finer.count[0], to);
        }
    };
    parallel_for(device.threads, nz, 1, "spao", progress, slice);
    progress.check();
}

void CoarseGrid::find_weights(const kernel::OpacityGrid& finest, const BlockMap& matter, const Device& device,
                              Progress& progress) {
    const auto run = kernel::spao_functions_for(device.isa);
    const int n = shape_.corners[0];
    const auto slice = [&](std::int64_t z, std::int64_t) {
        std::vector<std::uint16_t> around(4 * std::size_t(2 * n)), opacity(n);
        for (int y = 0; y < shape_.corners[1]; ++y) {
            std::uint16_t* to = as_shorts(weight_) + corner({0, y, int(z)});
            kernel::MipRows rows;
            bool any = false;
            for (int r = 0; r < 4; ++r) {  // cells 2 i - 1 and 2 i along each axis
                const int j = 2 * y - (r & 1), k = 2 * int(z) - (r >> 1);
                std::uint16_t* row = &around[r * std::size_t(2 * n)];
                rows.from[r] = row;
                std::fill_n(row, 2 * n, std::uint16_t(0));
                if (j < 0 || j >= finest.count[1] || k < 0 || k >= finest.count[2]) continue;
                if (!matter.any_in_row(j / block_edge, k / block_edge)) continue;
                std::copy_n(finest.row(j, k), std::min(finest.count[0], 2 * n - 1), row + 1);
                any = true;
            }
            if (!any) {
                std::fill_n(to, n, std::uint16_t(65535));
                continue;
            }
            run.mip_row(rows, n, opacity.data());
            for (int x = 0; x < n; ++x) to[x] = kernel::corner_weight(opacity[x]);
        }
    };
    parallel_for(device.threads, shape_.corners[2], 1, "spao", progress, slice);
    progress.check();
}

const std::uint16_t* CoarseGrid::weights(const Cells& first) const {
    return octants_ > 1 ? as_shorts(weight_) + corner(first) : nullptr;
}

kernel::SpaoOutput CoarseGrid::output(const Cells& first) {
    kernel::SpaoOutput to{.row = shape_.corners[0],
                          .slice = std::int64_t(shape_.corners[0]) * shape_.corners[1],
                          .nx = block_edge,
                          .ny = block_edge,
                          .nz = block_edge,
                          .pieces = all_pieces.bits};
    for (int s = 0; s < octants_; ++s) to.at[s] = as_shorts(open_) + s * shape_.corners_held() + corner(first);
    return to;
}

void CoarseGrid::load(const Cells& first, kernel::CoarseTile& tile) const {
    constexpr int edge = kernel::CoarseTile::edge;
    const auto copy = [&](const std::uint16_t* from, std::uint16_t* to) {
        const int x0 = first[0] / 2, inside = std::min(edge, shape_.corners[0] - x0);
        for (int k = 0; k < edge; ++k)
            for (int j = 0; j < edge; ++j, to += edge) {
                // Past the last corner lies no cell that asks.
                const int y = std::min(first[1] / 2 + j, shape_.corners[1] - 1),
                          z = std::min(first[2] / 2 + k, shape_.corners[2] - 1);
                const std::uint16_t* row = from + corner({x0, y, z});
                std::copy_n(row, inside, to);
                std::fill(to + inside, to + edge, row[inside - 1]);
            }
    };
    for (int s = 0; s < octants_; ++s) copy(as_shorts(open_) + s * shape_.corners_held(), tile.open[s]);
    if (octants_ > 1) copy(as_shorts(weight_), tile.weight);
}

}  // namespace chiaro
