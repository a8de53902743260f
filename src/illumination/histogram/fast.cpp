#include "illumination/histogram/fast.h"

#include <utility>

#include "illumination/histogram/ball.h"

namespace chiaro {
namespace {

using Block = kernel::FastBlock;
static_assert(Block::edge == block_edge);

void add_near(Block& block, int dx, int dy, int dz, float weight) {
    kernel::NearCells& near = block.near;
    const int i = near.count++;
    near.x[i] = float(dx), near.y[i] = float(dy), near.z[i] = float(dz), near.weight[i] = weight;
    near.distance[i] = dx + dy * block.tile_row + dz * block.tile_slice;
}

}  // namespace

FastShape::FastShape(const Packing& packing, int radius) {
    const FilterFit fit = fit_filters(radius);
    for (std::size_t j = 0; j < packing.low.size(); ++j)
        code.push_back(packing.low[j] | std::uint32_t(packing.share[j]) << 8 |
                       std::uint32_t(Packing::whole - packing.share[j]) << 17);
    const int fine = 2 * (Block::nodes + 2 * fit.reach);
    block.bins = padded_bins(packing.packed), block.reach = fit.reach;
    block.tile_row = fine, block.tile_slice = fine * fine, block.fine_first = 4 + 2 * fit.reach;
    block.boxes = int(fit.boxes.size());
    std::copy(fit.boxes.begin(), fit.boxes.end(), block.box);
    const Ball ball(radius, true);
    for (const Ball::Row& row : ball.rows)
        for (int dx = -row.reach; dx <= row.reach; ++dx)
            if (const int square = row.dy * row.dy + row.dz * row.dz + dx * dx; square > 0 && square <= near_square)
                add_near(block, dx, row.dy, row.dz, 2 * ball.weight[std::size_t(square)] / Packing::whole);
}

std::size_t carve_workspace(Block& b, const FastWorkspaceSize& room, std::byte* memory) {
    constexpr int n = Block::nodes;
    const int wide = n + 2 * b.reach;
    std::size_t bytes = 0;
    const auto take = [&](std::size_t numbers) {
        const std::size_t first = std::exchange(bytes, bytes + numbers * sizeof(float));
        return memory ? memory + first : nullptr;
    };
    const auto vectors = [&](int count) { return take(std::size_t(count) * std::size_t(b.bins)); };
    const auto ints = [&](int count) { return reinterpret_cast<std::int32_t*>(vectors(count)); };
    const auto floats = [&](int count) { return reinterpret_cast<float*>(vectors(count)); };
    const int rows = room.planes * room.rows;
    b.columns = ints(room.depths * wide * wide), b.rows = ints(room.depths * n * wide);
    b.mass = floats(n * n * n), b.blur = floats(n * n * n);
    b.plane = floats(room.planes * 3 * n * n), b.line = floats(4 * n * rows),
    b.near_bins =
        reinterpret_cast<float*>(take(std::size_t(rows * room.cells) * std::size_t(Block::near_numbers(b.bins))));
    b.tile = reinterpret_cast<std::uint32_t*>(take(std::size_t(b.tile_size())));
    return bytes;
}

FastHistograms::FastHistograms(const Device& device, const BinnedCells& cells, const Packing& packing, int radius)
    : HistogramSource(cells, padded_bins(packing.packed)),
      kernels_(kernel::histogram_functions_for(device.isa)),
      shape_(packing, radius) {}

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
    thread_local std::vector<std::byte> room;
    Block data = shape_.block;
    room.resize(carve_workspace(data, {}, nullptr));
    carve_workspace(data, {}, room.data());
    std::fill_n(data.tile, data.tile_size(), 0);
    const auto [nx, ny, nz] = cells_.grid.count;
    const int fine = data.tile_row;
    const int x0 = block[0].first - data.fine_first, y0 = block[1].first - data.fine_first,
              z0 = block[2].first - data.fine_first;
    for (int z = std::max(-z0, 0); z < std::min(fine, nz - z0); ++z)
        for (int y = std::max(-y0, 0); y < std::min(fine, ny - y0); ++y) {
            const std::uint16_t* from = cells_.data() + cells_.grid.index(0, y + y0, z + z0);
            std::uint32_t* to = data.tile + (std::size_t(z) * fine + y) * fine;
            for (int x = std::max(-x0, 0); x < std::min(fine, nx - x0); ++x) to[x] = shape_.code[from[x + x0]];
        }
    return data;
}

void FastHistograms::find_normals(int y, int z, const std::pair<int, int>& x, float* normals) const {
    const kernel::BinGrid cells = cells_.view();
    for (int i = x.first; i < x.second; ++i, normals += 3) {
        const kernel::Float3 n = cells.normal(i, y, z);
        normals[0] = n.x, normals[1] = n.y, normals[2] = n.z;
    }
}

}  // namespace chiaro
