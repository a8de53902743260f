#include "illumination/spao/means.h"

#include "illumination/spao/coarse.h"
#include "illumination/spao/steps.h"

namespace chiaro {
namespace {

constexpr int slab = 16;  ///< slices that one thread takes at a time

}  // namespace

kernel::StoredKernel stored_kernel(const kernel::StoredLevels& levels, const SpaoSettings& settings) {
    return {levels, settings.levels, kernel::SpaoProduct(settings.model), float(settings.normal_factor)};
}

kernel::ExactKernel exact_kernel(const kernel::OpacitySums& sums, const SpaoSettings& settings) {
    return {sums, settings.levels, kernel::SpaoProduct(settings.model), float(settings.normal_factor)};
}

LevelShape LevelShape::of(const CellGrid& grid) { return {{grid.count[0] + 2, grid.count[1] + 2, grid.count[2] + 2}}; }

LevelShape LevelShape::mipmap() const {
    // this = 2 coarse + ½ of the unpadded indices
    LevelShape coarse{count, scale / 2, (shift - 1 - 0.5) / 2 + 1};
    for (int& n : coarse.count) n = (n - 1) / 2 + 2;
    return coarse;
}

LevelShape LevelShape::nbuffer(int distance) const {
    // In cells of the N-buffers' grid: centre of the window from i on is i + (2 distance - 1) / 2, and was i +
    // (distance - 1) / 2; the first cell moved by `distance`.
    LevelShape wider{count, scale, shift + distance - distance / 2.0};
    for (int& n : wider.count) n += distance;
    return wider;
}

std::uint16_t* SpaoLevels::Level::row(int y, int z) {
    return reinterpret_cast<std::uint16_t*>(cells.data()) + (std::size_t(z) * shape.count[1] + y) * shape.count[0];
}
const std::uint16_t* SpaoLevels::Level::row(int y, int z) const { return const_cast<Level*>(this)->row(y, z); }

SpaoLevels::SpaoLevels(const Device& device, const CellOpacity& opacity, int mip_levels, int top, StageTimer& timer,
                       Progress& progress)
    : device_(device), run_(kernel::spao_functions_for(device.isa)), opacity_(opacity), progress_(progress) {
    level_steps(*this, mip_levels, top, timer);
}

kernel::StoredLevels SpaoLevels::view() const {
    kernel::StoredLevels view{};
    for (std::size_t l = 0; l < levels_.size(); ++l) view.at[l] = levels_[l].shape.view(levels_[l].row(0, 0));
    return view;
}

std::size_t SpaoLevels::bytes() const {
    std::size_t sum = 0;
    for (const Level& level : levels_) sum += level.cells.size();
    return sum;
}

void SpaoLevels::copy_opacity() {
    const CellGrid& grid = opacity_.values.grid;
    Level level(LevelShape::of(grid));
    const auto blocks = opacity_.matter.held();
    parallel_for(device_.threads, std::int64_t(blocks.size()), 1, "spao", progress_, [&](std::int64_t b, std::int64_t) {
        const auto [x, y, z] = opacity_.matter.cells(blocks[b], grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                std::copy_n(opacity_.values.data() + grid.index(x.first, j, k), x.second - x.first,
                            level.row(j + 1, k + 1) + x.first + 1);
    });
    progress_.check();
    levels_.push_back(std::move(level));
}

/// Mipmap cell i covers cells 2 i and 2 i + 1; the layer of zeros stands for the missing one where the number is odd.
void SpaoLevels::add_mipmap() {
    const Level& fine = levels_.back();
    Level level(fine.shape.mipmap());
    const auto& count = level.shape.count;
    parallel_for(device_.threads, count[2] - 2, 1, "spao", progress_, [&](std::int64_t z, std::int64_t) {
        for (int y = 0; y < count[1] - 2; ++y) {
            kernel::MipRows rows;
            for (int r = 0; r < 4; ++r)  // the last row of an odd number is followed by the layer of zeros
                rows.from[r] = fine.row(1 + 2 * y + (r & 1), 1 + 2 * int(z) + (r >> 1)) + 1;
            run_.mip_row(rows, count[0] - 2, level.row(y + 1, int(z) + 1) + 1);
        }
    });
    progress_.check();
    levels_.push_back(std::move(level));
}

/// B_l grows by `distance` cells at the low end of each axis.
void SpaoLevels::add_nbuffer(int distance) {
    const Level& inner = levels_.back();
    Level level(inner.shape.nbuffer(distance));
    const auto &count = level.shape.count, &inside = inner.shape.count;
    const std::vector<std::uint16_t> zeros(inside[0]);
    // Far apart, slices go in chains z, z + distance, ...: the far slice of one is the near slice of the next, still in
    // the cache. Close together, neighbours do.
    const int stride = distance < slab ? 1 : distance;
    const int pieces = stride == 1 ? (count[2] + slab - 1) / slab : distance;
    parallel_for(device_.threads, pieces, 1, "spao", progress_, [&](std::int64_t piece, std::int64_t) {
        std::vector<std::uint16_t> scratch(inside[0] + 2 * distance);
        const int first = stride == 1 ? int(piece) * slab : int(piece);
        const int end = stride == 1 ? std::min(first + slab, count[2]) : count[2];
        const auto source = [&](int y, int z) {
            const bool outside = y < 0 || y >= inside[1] || z < 0 || z >= inside[2];
            return outside ? zeros.data() : inner.row(y, z);
        };
        for (int z = first; z < end && !progress_.cancelled(); z += stride)
            for (int y = 0; y < count[1]; ++y) {
                const kernel::NBufferRows rows{{source(y - distance, z - distance), source(y, z - distance),
                                                source(y - distance, z), source(y, z)},
                                               inside[0],
                                               distance};
                run_.nbuffer_row(rows, scratch.data(), level.row(y, z));
            }
    });
    progress_.check();
    levels_.push_back(std::move(level));
}

SummedOpacity::SummedOpacity(const Device& device, const CellValues& opacity, Progress& progress)
    : count_(opacity.grid.count), sums_(sums_of(count_)) {
    const kernel::OpacityGrid cells = opacity_grid(count_, opacity.data());
    const int row = count_[0] + 1, ny = count_[1], nz = count_[2];
    const std::int64_t slice = std::int64_t(row) * (ny + 1);
    parallel_for(device.threads, nz, 1, "spao", progress, [&](std::int64_t z, std::int64_t) {
        for (int y = 0; y < ny; ++y) kernel::sum_cells(cells, y, int(z), sums_.data());
        kernel::add_up(sums_.data() + (z + 1) * slice, ny + 1, row, row);
    });
    progress.check();
    parallel_for(device.threads, ny, 1, [&](std::int64_t y, std::int64_t) {
        kernel::add_up(sums_.data() + (y + 1) * row, nz + 1, slice, row);
    });
}

}  // namespace chiaro
