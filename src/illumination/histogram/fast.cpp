#include "illumination/histogram/fast.h"

#include "illumination/histogram/ball.h"

namespace chiaro {
namespace {

using Block = kernel::FastBlock;
static_assert(Block::edge == block_edge);

/// What a thread needs for a block.
struct Room {
    std::vector<std::uint32_t> tile;
    std::vector<std::int32_t> columns, rows, row_sum;
    std::vector<float> mass, blur, plane, line, near_bins;
};

}  // namespace

std::array<float, 3> normal_of(const BinnedCells& cells, int x, int y, int z) {
    auto g = cells.gradient(x, y, z);
    const float length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    for (float& component : g) component = length > 0 ? component / length : 0;
    return g;
}

FastHistograms::FastHistograms(const Device& device, const BinnedCells& cells, const Packing& packing, int radius)
    : HistogramSource(cells, padded_bins(packing.packed)),
      kernels_(kernel::histogram_functions_for(device.isa)),
      fit_(fit_filters(radius)) {
    for (std::size_t j = 0; j < packing.low.size(); ++j)
        code_.push_back(packing.low[j] | std::uint32_t(packing.share[j]) << 8 |
                        std::uint32_t(Packing::whole - packing.share[j]) << 17);
    const Ball ball(radius, true);
    for (const Ball::Row& row : ball.rows)
        for (int dx = -row.reach; dx <= row.reach; ++dx)
            if (const int square = row.dy * row.dy + row.dz * row.dz + dx * dx; square > 0 && square <= near_square)
                near_.push_back({float(dx), float(row.dy), float(row.dz),
                                 2 * ball.weight[std::size_t(square)] / Packing::whole, 0});
}

void FastHistograms::find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const {
    thread_local std::vector<float> normals(3 * Block::edge);
    thread_local std::vector<PackedHistogram> histograms;
    histograms.resize(std::size_t(2 * Block::edge * bins_));
    const auto range = BlockMap(cells_.grid.count).cells(block, cells_.grid.count);
    const Block data = load(range);
    kernels_.fast_sums(data);
    int plane = -1;
    for_rows(block, step, wanted, [&](const std::pair<int, int>& x, int y, int z) {
        if (plane != z) kernels_.fast_plane(data, z - range[2].first);
        plane = z;
        find_normals(y, z, x, normals.data());
        kernels_.fast_cells(data, y - range[1].first, z - range[2].first, x.second - x.first, step, normals.data(),
                            histograms.data());
        use_row(y, z, histograms.data());
    });
}

Block FastHistograms::load(const std::array<std::pair<int, int>, 3>& block) const {
    thread_local Room room;
    const int n = Block::nodes, wide = n + 2 * fit_.reach, fine = 2 * wide, first = 4 + 2 * fit_.reach;
    room.tile.assign(std::size_t(fine) * fine * fine, 0);
    const auto [nx, ny, nz] = cells_.grid.count;
    const int x0 = block[0].first - first, y0 = block[1].first - first, z0 = block[2].first - first;
    for (int z = std::max(-z0, 0); z < std::min(fine, nz - z0); ++z)
        for (int y = std::max(-y0, 0); y < std::min(fine, ny - y0); ++y) {
            const std::uint16_t* from = cells_.data() + cells_.grid.index(0, y + y0, z + z0);
            std::uint32_t* to = room.tile.data() + (std::size_t(z) * fine + y) * fine;
            for (int x = std::max(-x0, 0); x < std::min(fine, nx - x0); ++x) to[x] = code_[from[x + x0]];
        }
    const std::size_t bins = std::size_t(bins_);
    room.columns.resize(std::size_t(wide) * wide * bins), room.rows.resize(std::size_t(n) * wide * bins);
    room.mass.resize(std::size_t(n) * n * n * bins), room.blur.resize(room.mass.size());
    room.plane.resize(3 * std::size_t(n) * n * bins), room.line.resize(4 * std::size_t(n) * bins);
    room.near_bins.resize(2 * bins), room.row_sum.resize(std::size_t(n) * bins);

    Block data{};
    data.bins = bins_, data.reach = fit_.reach;
    data.tile = room.tile.data(), data.tile_row = fine, data.tile_slice = fine * fine, data.fine_first = first;
    data.boxes = int(fit_.boxes.size()), data.near_count = int(near_.size());
    std::copy(fit_.boxes.begin(), fit_.boxes.end(), data.box);
    std::copy(near_.begin(), near_.end(), data.near);
    for (int i = 0; i < data.near_count; ++i) {
        kernel::NearCell& c = data.near[i];
        c.distance = int(c.x) + int(c.y) * data.tile_row + int(c.z) * data.tile_slice;
    }
    data.columns = room.columns.data(), data.rows = room.rows.data(), data.row_sum = room.row_sum.data();
    data.mass = room.mass.data(), data.blur = room.blur.data();
    data.plane = room.plane.data(), data.line = room.line.data(), data.near_bins = room.near_bins.data();
    return data;
}

void FastHistograms::find_normals(int y, int z, const std::pair<int, int>& x, float* normals) const {
    for (int i = x.first; i < x.second; ++i) {
        const auto n = normal_of(cells_, i, y, z);
        std::copy(n.begin(), n.end(), normals + 3 * (i - x.first));
    }
}

}  // namespace chiaro
