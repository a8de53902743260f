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
    needed.pieces.resize(needed.holds.size());
    for (const std::size_t b : finer.held()) {
        const BlockPieces& pieces = finer.pieces_of(b);
        const auto [x, y, z] = finer.at(b);
        for (int k = 0; k < block_edge / BlockPieces::height; ++k)
            for (int j = 0; j < block_edge / BlockPieces::height; ++j)
                for (int i = 0; i < block_edge / BlockPieces::width; ++i)
                    if (pieces.bits[k][j] >> i & 1)
                        need_piece(needed,
                                   {x * block_edge + i * BlockPieces::width, y * block_edge + j * BlockPieces::height,
                                    z * block_edge + k * BlockPieces::height});
    }
    return needed;
}

/// The pieces of corners that a piece of the finer grid reads: half of its cells or corners from `first` on, and one
/// more.
void CoarseShape::need_piece(BlockMap& needed, const std::array<int, 3>& first) const {
    const std::array<int, 3> size{BlockPieces::width, BlockPieces::height, BlockPieces::height};
    std::array<std::pair<int, int>, 3> read;  // pieces
    for (int axis = 0; axis < 3; ++axis) {
        const int begin = first[axis] / 2, last = std::min(begin + size[axis] / 2, corners[axis] - 1);
        read[axis] = {begin / size[axis], last / size[axis]};
    }
    constexpr int rows = block_edge / BlockPieces::height, columns = block_edge / BlockPieces::width;
    for (int z = read[2].first; z <= read[2].second; ++z)
        for (int y = read[1].first; y <= read[1].second; ++y)
            for (int x = read[0].first; x <= read[0].second; ++x) {
                const std::size_t block = needed.index(x / columns, y / rows, z / rows);
                needed.holds[block] = 1;
                needed.pieces[block].bits[z % rows][y % rows] |= 1 << x % columns;
            }
}

CoarseGrid::CoarseGrid(const Cells& finer, int octants)
    : octants_(octants), shape_(finer), opacity_(shape_.cells_held() * sizeof(std::uint16_t)) {
    for (int axis = 0; axis < 3; ++axis) corners_[axis] = shape_.count[axis] + 1;
    hold(0, corners_[2]);
}

CoarseGrid::CoarseGrid(const CellOpacity& finest, int octants, const Device& device, Progress& progress)
    : CoarseGrid(finest.values.grid.count, octants) {
    const CellRows cells = rows_of(finest.values);
    shrink(cells, &finest.matter, device, 0, shape_.count[2]);
    progress.check();
    find_weights(cells, finest.matter, 1, device, 0, corners_[2]);
    progress.check();
}

CoarseGrid::CoarseGrid(const CoarseGrid& finer, const Device& device, Progress& progress)
    : CoarseGrid(finer.shape_.count, finer.octants_) {
    shrink(finer.cells(), nullptr, device, 0, shape_.count[2]);
    progress.check();
    if (octants_ == 1) return;
    const auto [nx, ny, nz] = finer.corners_;
    const kernel::EveryOther weights{as_shorts(finer.weight_), {nx, ny, nz}};
    for (int z = 0; z < corners_[2]; ++z)
        for (int y = 0; y < corners_[1]; ++y)
            for (int x = 0; x < corners_[0]; ++x) as_shorts(weight_)[corner({x, y, z})] = weights.at(x, y, z);
}

void CoarseGrid::hold(int first_slice, int slices) {
    first_slice_ = first_slice;
    if (slices == slices_) return;
    slices_ = slices;
    constexpr std::size_t spare = 2 * kernel::SpaoTile::piece;  // a piece is read, and one corner more
    const auto buffer = [&](std::size_t row) {
        return VoxelBuffer((std::size_t(slices) * corners_[1] * row + spare) * sizeof(std::uint16_t));
    };
    open_ = VoxelBuffer(), weight_ = VoxelBuffer();
    open_ = buffer(open_row());
    if (small_pages_) open_.use_small_pages();
    if (octants_ > 1) weight_ = buffer(std::size_t(corners_[0]));
}

void CoarseGrid::discard_cells_before(int slice) {
    if (slice > 0)
        opacity_.discard_before(std::size_t(slice) * shape_.count[0] * shape_.count[1] * sizeof(std::uint16_t));
}

void CoarseGrid::discard_corners_before(int slice) {
    open_.discard_before(open_corner({0, 0, slice}) * sizeof(std::uint16_t));
    weight_.discard_before(corner({0, 0, slice}) * sizeof(std::uint16_t));
}

void CoarseGrid::shrink(const CellRows& finer, const BlockMap* matter, const Device& device, int first, int end) {
    const auto functions = kernel::spao_functions_for(device.isa);
    const auto run = octants_ > 1 ? functions.crossing_row : functions.mip_row;
    const std::vector<std::uint16_t> zeros(finer.count[0]);
    const int nx = shape_.count[0], ny = shape_.count[1];
    parallel_for(device.threads, end - first, 1, [&](std::int64_t i, std::int64_t) {
        const int z = first + int(i);
        for (int y = 0; y < ny; ++y) {
            kernel::MipRows rows;
            for (int r = 0; r < 4; ++r) {
                const int j = 2 * y + (r & 1), k = 2 * z + (r >> 1);
                rows.from[r] = j < finer.count[1] && k < finer.count[2] ? finer.row(j, k) : zeros.data();
            }
            std::uint16_t* to = as_shorts(opacity_) + (std::size_t(z) * ny + y) * nx;
            for (int x = 0; x < nx; x += half_block)
                if (!matter || matter->at(x / half_block, y / half_block, z / half_block))
                    shrink_row(run, rows, x, std::min(x + half_block, nx), finer.count[0], to);
        }
    });
}

/// Row (y, z) of the corners of the first coarse grid: of cells 2 i - 1 and 2 i along each axis.
void CoarseGrid::weigh_row(const CellRows& finest, const BlockMap& matter, const Device& device, int y, int z,
                           std::vector<std::uint16_t>& to) const {
    const auto run = kernel::spao_functions_for(device.isa);
    const int n = int(to.size()), nx = finest.count[0], whole = std::min(n, (nx + 1) / 2);
    thread_local std::vector<std::uint16_t> zeros;
    zeros.resize(std::size_t(nx) + 1);
    kernel::MipRows rows;
    bool any = false;
    for (int r = 0; r < 4; ++r) {
        const int j = 2 * y - (r & 1), k = 2 * z - (r >> 1);
        const bool is_inside = j >= 0 && j < finest.count[1] && k >= 0 && k < finest.count[2];
        const bool may_hold = is_inside && matter.any_in_row(j / block_edge, k / block_edge);
        rows.from[r] = (may_hold ? finest.row(j, k) : zeros.data()) + 1;  // where corner 1 reads
        any = any || may_hold;
    }
    if (!any) return to.assign(to.size(), 65535);
    if (whole > 1) run.mip_row(rows, whole - 1, &to[1]);
    // At the border one of the two cells is missing.
    const auto at_border = [&](int corner, int cell) {
        std::uint16_t cells[4][2] = {};
        for (int r = 0; r < 4; ++r) cells[r][0] = cell < nx ? rows.from[r][cell - 1] : std::uint16_t(0);
        run.mip_row({{cells[0], cells[1], cells[2], cells[3]}}, 1, &to[std::size_t(corner)]);
    };
    at_border(0, 0);
    for (int corner = std::max(whole, 1); corner < n; ++corner) at_border(corner, 2 * corner - 1);
    for (std::uint16_t& opacity : to) opacity = kernel::corner_weight(opacity);
}

void CoarseGrid::find_weights(const CellRows& finest, const BlockMap& matter, int stride, const Device& device,
                              int first, int end) {
    if (octants_ == 1) return;
    // A row of the first coarse grid, which all of these corners belong to or lie beyond.
    const std::size_t n = std::size_t(stride) * std::size_t(corners_[0]);
    parallel_for(device.threads, end - first, 1, [&](std::int64_t i, std::int64_t) {
        const int z = first + int(i);
        std::vector<std::uint16_t> row(n);
        for (int y = 0; y < corners_[1]; ++y) {
            weigh_row(finest, matter, device, stride * y, stride * z, row);
            std::uint16_t* to = as_shorts(weight_) + corner({0, y, z});
            for (int x = 0; x < corners_[0]; ++x) to[x] = row[std::size_t(stride) * std::size_t(x)];
        }
    });
}

void CoarseGrid::weigh(const Cells& first, kernel::SpaoBlock& block) const {
    if (octants_ == 1) return;
    block.weight = as_shorts(weight_) + corner(first);
    block.weight_row = corners_[0], block.weight_slice = std::int64_t(corners_[0]) * corners_[1];
}

kernel::SpaoOutput CoarseGrid::output(const Cells& first, int slices, const BlockPieces& pieces) {
    kernel::SpaoOutput to{.row = std::int64_t(open_row()),
                          .slice = std::int64_t(open_row()) * corners_[1],
                          .nx = std::min(block_edge, corners_[0] - first[0]),
                          .ny = std::min(block_edge, corners_[1] - first[1]),
                          .nz = std::min(slices, corners_[2] - first[2]),
                          .pieces = pieces.bits};
    for (int s = 0; s < octants_; ++s) to.at[s] = as_shorts(open_) + open_corner(first) + std::size_t(s) * corners_[0];
    return to;
}

kernel::CoarseRows CoarseGrid::rows_for(const Cells& first) const {
    const Cells at{first[0] / 2, first[1] / 2, first[2] / 2};
    kernel::CoarseRows rows{.row = std::int64_t(open_row()),
                            .slice = std::int64_t(open_row()) * corners_[1],
                            .last_row = corners_[1] - 1 - at[1],
                            .last_slice = corners_[2] - 1 - at[2]};
    for (int s = 0; s < octants_; ++s) rows.open[s] = as_shorts(open_) + open_corner(at) + std::size_t(s) * corners_[0];
    if (octants_ == 1) return rows;
    rows.weight = as_shorts(weight_) + corner(at);
    rows.weight_row = corners_[0], rows.weight_slice = std::int64_t(corners_[0]) * corners_[1];
    return rows;
}

}  // namespace chiaro
