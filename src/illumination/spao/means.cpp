#include "illumination/spao/means.h"

#include <cmath>

namespace chiaro {
namespace {

constexpr int slab = 16;  ///< slices that one thread takes at a time

}  // namespace

kernel::StoredKernel stored_kernel(const kernel::StoredLevels& levels, const SpaoSettings& settings) {
    return {levels, settings.levels, kernel::SpaoProduct(settings.model), float(settings.normal_factor)};
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

SpaoLevels::SpaoLevels(const Device& device, const CellOpacity& opacity, int mip_levels, int top, Steps& steps,
                       Progress& progress)
    : device_(device), run_(kernel::spao_functions_for(device.isa)) {
    steps(name_of_level(0), [&] { copy_opacity(opacity, progress); });
    for (int level = 1; level <= top; ++level)
        steps(name_of_level(level), [&] {
            level <= mip_levels ? add_mipmap(progress) : add_nbuffer(1 << (level - mip_levels - 1), progress);
        });
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

void SpaoLevels::copy_opacity(const CellOpacity& opacity, Progress& progress) {
    const CellGrid& grid = opacity.values.grid;
    Level level(LevelShape::of(grid));
    const auto blocks = opacity.matter.held();
    parallel_for(device_.threads, std::int64_t(blocks.size()), 1, "spao", progress, [&](std::int64_t b, std::int64_t) {
        const auto [x, y, z] = opacity.matter.cells(blocks[b], grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j)
                std::copy_n(opacity.values.data() + grid.index(x.first, j, k), x.second - x.first,
                            level.row(j + 1, k + 1) + x.first + 1);
    });
    progress.check();
    levels_.push_back(std::move(level));
}

/// Mipmap cell i covers cells 2 i and 2 i + 1; the layer of zeros stands for the missing one where the number is odd.
void SpaoLevels::add_mipmap(Progress& progress) {
    const Level& fine = levels_.back();
    Level level(fine.shape.mipmap());
    const auto& count = level.shape.count;
    parallel_for(device_.threads, count[2] - 2, 1, "spao", progress, [&](std::int64_t z, std::int64_t) {
        for (int y = 0; y < count[1] - 2; ++y) {
            kernel::MipRows rows;
            for (int r = 0; r < 4; ++r)  // the last row of an odd number is followed by the layer of zeros
                rows.from[r] = fine.row(1 + 2 * y + (r & 1), 1 + 2 * int(z) + (r >> 1)) + 1;
            run_.mip_row(rows, count[0] - 2, level.row(y + 1, int(z) + 1) + 1);
        }
    });
    progress.check();
    levels_.push_back(std::move(level));
}

/// B_l grows by `distance` cells at the low end of each axis.
void SpaoLevels::add_nbuffer(int distance, Progress& progress) {
    const Level& inner = levels_.back();
    Level level(inner.shape.nbuffer(distance));
    const auto &count = level.shape.count, &inside = inner.shape.count;
    const std::vector<std::uint16_t> zeros(inside[0]);
    // Far apart, slices go in chains z, z + distance, ...: the far slice of one is the near slice of the next, still in
    // the cache. Close together, neighbours do.
    const int stride = distance < slab ? 1 : distance;
    const int pieces = stride == 1 ? (count[2] + slab - 1) / slab : distance;
    parallel_for(device_.threads, pieces, 1, "spao", progress, [&](std::int64_t piece, std::int64_t) {
        std::vector<std::uint16_t> scratch(inside[0] + 2 * distance);
        const int first = stride == 1 ? int(piece) * slab : int(piece);
        const int end = stride == 1 ? std::min(first + slab, count[2]) : count[2];
        const auto source = [&](int y, int z) {
            const bool outside = y < 0 || y >= inside[1] || z < 0 || z >= inside[2];
            return outside ? zeros.data() : inner.row(y, z);
        };
        for (int z = first; z < end && !progress.cancelled(); z += stride)
            for (int y = 0; y < count[1]; ++y) {
                const kernel::NBufferRows rows{{source(y - distance, z - distance), source(y, z - distance),
                                                source(y - distance, z), source(y, z)},
                                               inside[0],
                                               distance};
                run_.nbuffer_row(rows, scratch.data(), level.row(y, z));
            }
    });
    progress.check();
    levels_.push_back(std::move(level));
}

SummedOpacity::SummedOpacity(const CellValues& opacity, Progress& progress) : count_(opacity.grid.count) {
    const auto [nx, ny, nz] = count_;
    const std::size_t row = nx + 1, slice = row * (ny + 1);
    sums_.assign(slice * (nz + 1), 0);
    for (int z = 1; z <= nz; ++z) {
        progress.check();
        for (int y = 1; y <= ny; ++y) {
            std::int64_t along = 0;
            for (int x = 1; x <= nx; ++x) {
                const std::size_t at = z * slice + y * row + x;
                along += opacity.data()[opacity.grid.index(x - 1, y - 1, z - 1)];
                sums_[at] = along + sums_[at - row] + sums_[at - slice] - sums_[at - row - slice];
            }
        }
    }
}

double SummedOpacity::below(double x, double y, double z) const {
    const auto split = [](double v, int n, std::size_t& first) {
        v = std::clamp(v, 0.0, double(n));
        first = std::size_t(std::min(int(v), n - 1));
        return v - double(first);
    };
    std::size_t i, j, k;
    const double t = split(x, count_[0], i), u = split(y, count_[1], j), v = split(z, count_[2], k);
    const std::size_t row = count_[0] + 1, slice = row * (count_[1] + 1);
    const std::int64_t* s = &sums_[k * slice + j * row + i];
    const auto plane = [&](const std::int64_t* p) {
        const double a = double(p[0]) + t * double(p[1] - p[0]), b = double(p[row]) + t * double(p[row + 1] - p[row]);
        return a + u * (b - a);
    };
    const double a = plane(s), b = plane(s + slice);
    return a + v * (b - a);
}

double SummedOpacity::mean(double width, Vec3 p) const {
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const auto side = [&](int bit, double c) { return c + 0.5 + (corner & bit ? 0.5 : -0.5) * width; };
        const int low_sides = !(corner & 1) + !(corner & 2) + !(corner & 4);
        sum += (low_sides % 2 ? -1 : 1) * below(side(1, p.x), side(2, p.y), side(4, p.z));
    }
    return sum / (width * width * width);
}

}  // namespace chiaro
