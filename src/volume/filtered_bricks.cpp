#include "volume/filtered_bricks.h"

#include <algorithm>
#include <cstring>

#include "core/threads.h"
#include "volume/device_view.h"
#include "volume/launch_spline.h"

namespace chiaro {
namespace {

using kernel::Lines;

/// Slices beyond a layer's own that its coefficients are found with: one depends on a voxel k away by .27^k.
constexpr int apron = 12;

/// Filters lines in place: one number depends on others far away only by what is negligible.
class LineFilter {
public:
    /// `longest`: of the lines.
    LineFilter(Filter filter, Isa isa, int longest) : filter_(filter), run_(kernel::spline_functions_for(isa)) {
        if (filter == Filter::coefficients)
            for (float factor = 0; int(factors_.size()) < longest; factor = 1 / (4 - factor))
                factors_.push_back(factor);
    }

    void operator()(const Lines& lines) const {
        if (filter_ == Filter::coefficients)
            run_.to_coefficients(lines, factors_.data());
        else
            run_.smooth(lines, std::vector<float>(std::size_t(lines.lanes)).data());
    }

private:
    Filter filter_;
    kernel::SplineFunctions run_;
    std::vector<float> factors_;  // what elimination multiplies each row with
};

/// Columns of a block of `rows` rows: the block on its side.
void transpose(const float* from, std::ptrdiff_t from_stride, int rows, int columns, float* to,
               std::ptrdiff_t to_stride) {
    typedef float Four __attribute__((vector_size(16)));
    const auto load = [](const float* four) {
        Four loaded;
        std::memcpy(&loaded, four, sizeof loaded);
        return loaded;
    };
    int x = 0;
    for (; x + 4 <= columns && rows % 4 == 0; x += 4)
        for (int y = 0; y < rows; y += 4) {
            const float* block = from + y * from_stride + x;
            const Four a = load(block), b = load(block + from_stride), c = load(block + 2 * from_stride),
                       d = load(block + 3 * from_stride);
            const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
            const Four ef = __builtin_shufflevector(a, b, 2, 6, 3, 7), gh = __builtin_shufflevector(c, d, 2, 6, 3, 7);
            const Four made[] = {
                __builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
                __builtin_shufflevector(ef, gh, 0, 1, 4, 5), __builtin_shufflevector(ef, gh, 2, 3, 6, 7)};
            for (int i = 0; i < 4; ++i) std::memcpy(to + (x + i) * to_stride + y, &made[i], sizeof made[i]);
        }
    for (; x < columns; ++x)
        for (int y = 0; y < rows; ++y) to[x * to_stride + y] = from[y * from_stride + x];
}

/// The numbers of one brick, border included: beyond the volume the last one of each axis stands or, of coefficients,
/// what goes straight on from the last two.
class Brick {
public:
    template <class Slab>
    Brick(const Slab& slab, const std::array<int, 3>& n, const std::array<int, 3>& at, bool goes_on) {
        std::array<int, 3> first;
        for (std::size_t a = 0; a < 3; ++a) first[a] = at[a] * brick_edge - brick_before;
        const bool inside = first[0] >= 0 && first[0] + brick_row <= n[0];
        for (int z = 0; z < brick_row; ++z)
            for (int y = 0; y < brick_row; ++y) {
                const float* row = slab.row(first[1] + y, first[2] + z);
                float* to = &values_[std::size_t((z * brick_row + y) * brick_row)];
                if (inside)
                    std::copy_n(row + first[0], brick_row, to);
                else
                    for (int x = 0; x < brick_row; ++x) to[x] = row[std::clamp(first[0] + x, 0, n[0] - 1)];
            }
        const int strides[] = {1, brick_row, brick_slice};
        for (std::size_t a = 0; goes_on && a < 3; ++a) {
            if (n[a] == 1) continue;
            for (const int beyond : {-1, n[a]}) {
                const int i = beyond - first[a];
                if (i >= 0 && i < brick_row) extend(i * strides[a], beyond < 0 ? strides[a] : -strides[a], a);
            }
        }
    }
    const float* values() const { return values_.data(); }

private:
    /// A whole plane across `axis`, which starts at `plane`.
    void extend(int plane, int inwards, std::size_t axis) {
        const int along = axis == 0 ? brick_row : 1, across = axis == 2 ? brick_row : brick_slice;
        for (int i = 0; i < brick_row; ++i)
            for (int j = 0; j < brick_row; ++j) {
                float* to = &values_[std::size_t(plane + i * along + j * across)];
                *to = 2 * to[inwards] - to[2 * inwards];
            }
    }
    std::array<float, brick_voxels> values_;
};

}  // namespace

/// The slices of the voxels that a layer of bricks needs, filtered along all axes.
class FilteredBricks::Slab {
public:
    Slab(const DeviceVolume::Data& source, Filter filter)
        : source_(source),
          filter_(filter, source.device.isa, std::ranges::max(source.dimensions)),
          n_(source.dimensions),
          values_(new float[slice_size() * std::size_t(std::min(brick_row + 2 * apron, n_[2]))]) {}

    void fill(int layer) {
        first_ = std::max(layer * brick_edge - brick_before - apron, 0);
        count_ = std::min((layer + 1) * brick_edge + brick_behind + apron, n_[2]) - first_;
        parallel_for(source_.device.threads, count_, 1, [&](std::int64_t z, std::int64_t) {
            with_stored_voxel(source_, [&](auto zero) { load<decltype(zero)>(int(z)); });
            float* slice = &values_[slice_size() * std::size_t(z)];
            filter_rows(slice);
            filter_({slice, n_[0], n_[1], n_[0]});
        });
        parallel_for(source_.device.threads, n_[1], 1, [&](std::int64_t y, std::int64_t) {
            for (int x = 0; x < n_[0]; x += near)
                filter_({&values_[std::size_t(y) * n_[0] + x], std::ptrdiff_t(slice_size()), count_,
                         std::min(near, n_[0] - x)});
        });
    }

    /// Row y of slice z, either clamped to the volume.
    const float* row(int y, int z) const {
        return &values_[std::size_t(std::clamp(z, first_, first_ + count_ - 1) - first_) * slice_size() +
                        std::size_t(std::clamp(y, 0, n_[1] - 1)) * n_[0]];
    }

private:
    /// Lines along z so many at a time: all their rows lie in the nearest cache, for slices begin a line and half a
    /// page apart from where they would.
    static constexpr int near = 128;
    std::size_t slice_size() const { return (std::size_t(n_[0]) * n_[1] + 1023) / 1024 * 1024 + 512 + 16; }

    template <class Voxel>
    void load(int z) {
        for (int y = 0; y < n_[1]; ++y) {
            float* row = &values_[slice_size() * std::size_t(z) + std::size_t(y) * n_[0]];
            for_each_run<Voxel>(source_, y, z + first_,
                                [&](int x, int count, const Voxel* from) { std::copy_n(from, count, row + x); });
        }
    }

    /// Along x, some rows side by side.
    void filter_rows(float* slice) const {
        constexpr int together = 16;
        std::vector<float> columns(together * std::size_t(n_[0]));
        for (int y = 0; y < n_[1]; y += together) {
            const int rows = std::min(together, n_[1] - y);
            float* from = slice + std::size_t(y) * n_[0];
            transpose(from, n_[0], rows, n_[0], columns.data(), together);
            filter_({columns.data(), together, n_[0], rows});
            transpose(columns.data(), together, n_[0], rows, from, n_[0]);
        }
    }

    const DeviceVolume::Data& source_;
    LineFilter filter_;
    std::array<int, 3> n_;
    int first_ = 0, count_ = 0;
    std::unique_ptr<float[]> values_;  // as many as the thickest slab has
};

FilteredBricks::FilteredBricks(const DeviceVolume::Data& source, Filter filter)
    : source_(source), filter_(filter), slab_(std::make_unique<Slab>(source, filter)) {}
FilteredBricks::~FilteredBricks() = default;

void FilteredBricks::for_each(const Progress& progress, const VisitBrick& visit) {
    const auto [nx, ny, nz] = source_.dimensions;
    const int bricks_x = brick_count(nx), bricks_y = brick_count(ny);
    for (int layer = 0; layer < brick_count(nz); ++layer) {
        progress.check();
        slab_->fill(layer);
        parallel_for(source_.device.threads, bricks_x * bricks_y, 1, [&](std::int64_t b, std::int64_t) {
            const std::array<int, 3> at{int(b % bricks_x), int(b / bricks_x), layer};
            visit(Brick(*slab_, source_.dimensions, at, filter_ == Filter::coefficients).values(), at);
        });
    }
}

}  // namespace chiaro
