#include "volume/filtered_bricks.h"

#include <algorithm>

#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// Slices beyond a layer's own that its coefficients are found with: one depends on a voxel k away by .27^k.
constexpr int apron = 12;

/// The slices of the voxels that a layer of bricks needs, filtered along all axes.
class Slab {
public:
    Slab(const DeviceVolume::Data& source, int layer, Filter filter)
        : n_(source.dimensions),
          first_(std::max(layer * brick_edge - brick_before - apron, 0)),
          count_(std::min((layer + 1) * brick_edge + brick_behind + apron, n_[2]) - first_),
          values_(std::size_t(n_[0]) * n_[1] * count_) {
        const int threads = source.device.threads;
        parallel_for(threads, count_, 1, [&](std::int64_t z, std::int64_t) {
            with_stored_voxel(source, [&](auto zero) { load<decltype(zero)>(source, int(z)); });
            float* slice = &values_[slice_size() * std::size_t(z)];
            filter_rows(slice, filter);
            filter({slice, n_[0], n_[1], n_[0]});
        });
        parallel_for(threads, n_[1], 1, [&](std::int64_t y, std::int64_t) {
            filter({&values_[std::size_t(y) * n_[0]], std::ptrdiff_t(slice_size()), count_, n_[0]});
        });
    }

    /// Row y of slice z, either clamped to the volume.
    const float* row(int y, int z) const {
        return &values_[(std::size_t(std::clamp(z, first_, first_ + count_ - 1) - first_) * n_[1] +
                         std::size_t(std::clamp(y, 0, n_[1] - 1))) *
                        n_[0]];
    }

private:
    std::size_t slice_size() const { return std::size_t(n_[0]) * n_[1]; }

    template <class Voxel>
    void load(const DeviceVolume::Data& source, int z) {
        const auto* voxels = reinterpret_cast<const Voxel*>(source.bricks.data());
        for (int y = 0; y < n_[1]; ++y)
            for (int x = 0; x < n_[0]; x += brick_edge) {
                const int end = x + brick_edge + 1 < n_[0] ? x + brick_edge : n_[0];
                const Voxel* from = voxels + voxel_index(source, x, y, z + first_);
                std::copy(from, from + (end - x), &values_[slice_size() * z + std::size_t(y) * n_[0] + x]);
                if (end == n_[0]) break;
            }
    }

    /// Along x, some rows side by side.
    void filter_rows(float* slice, Filter filter) const {
        constexpr int together = 16;
        std::vector<float> columns(together * std::size_t(n_[0]));
        for (int y = 0; y < n_[1]; y += together) {
            const int rows = std::min(together, n_[1] - y);
            for (int r = 0; r < rows; ++r)
                for (int x = 0; x < n_[0]; ++x)
                    columns[std::size_t(x) * together + r] = slice[std::size_t(y + r) * n_[0] + x];
            filter({columns.data(), together, n_[0], rows});
            for (int r = 0; r < rows; ++r)
                for (int x = 0; x < n_[0]; ++x)
                    slice[std::size_t(y + r) * n_[0] + x] = columns[std::size_t(x) * together + r];
        }
    }

    std::array<int, 3> n_;
    int first_, count_;
    std::vector<float> values_;
};

/// The numbers of one brick, border included: beyond the volume the last one of each axis stands or, of coefficients,
/// what goes straight on from the last two.
class Brick {
public:
    Brick(const Slab& slab, const std::array<int, 3>& n, const std::array<int, 3>& at, bool goes_on)
        : values_(brick_voxels) {
        std::array<int, 3> first;
        for (std::size_t a = 0; a < 3; ++a) first[a] = at[a] * brick_edge - brick_before;
        for (int z = 0; z < brick_row; ++z)
            for (int y = 0; y < brick_row; ++y) {
                const float* row = slab.row(first[1] + y, first[2] + z);
                for (int x = 0; x < brick_row; ++x)
                    values_[std::size_t((z * brick_row + y) * brick_row + x)] =
                        row[std::clamp(first[0] + x, 0, n[0] - 1)];
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
    const std::vector<float>& values() const { return values_; }

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
    std::vector<float> values_;
};

}  // namespace

void to_coefficients(const Lines& v) {
    std::vector<float> m(v.n, 0.0f);
    for (int i = 1; i + 1 < v.n; ++i) {
        const float factor = m[std::size_t(i)] = 1 / (4 - m[std::size_t(i) - 1]);
        float* here = v.row(i);
        const float* before = v.row(i - 1);
        for (int lane = 0; lane < v.lanes; ++lane) here[lane] = (6 * here[lane] - before[lane]) * factor;
    }
    for (int i = v.n - 2; i > 0; --i) {
        float* here = v.row(i);
        const float *behind = v.row(i + 1), factor = m[std::size_t(i)];
        for (int lane = 0; lane < v.lanes; ++lane) here[lane] -= factor * behind[lane];
    }
}

void smooth(const Lines& v) {
    std::vector<float> before(v.row(0), v.row(0) + v.lanes);
    for (int i = 0; i < v.n; ++i) {
        float* here = v.row(i);
        const float* behind = v.row(std::min(i + 1, v.n - 1));
        for (int lane = 0; lane < v.lanes; ++lane) {
            const float was = here[lane];
            here[lane] = (before[std::size_t(lane)] + 4 * was + behind[lane]) * (1.0f / 6);
            before[std::size_t(lane)] = was;
        }
    }
}

void for_each_brick(const DeviceVolume::Data& source, Filter filter, const Progress& progress,
                    const VisitBrick& visit) {
    const auto [nx, ny, nz] = source.dimensions;
    const int bricks_x = brick_count(nx), bricks_y = brick_count(ny);
    for (int layer = 0; layer < brick_count(nz); ++layer) {
        progress.check();
        const Slab slab(source, layer, filter);
        parallel_for(source.device.threads, bricks_x * bricks_y, 1, [&](std::int64_t b, std::int64_t) {
            const std::array<int, 3> at{int(b % bricks_x), int(b / bricks_x), layer};
            visit(Brick(slab, source.dimensions, at, filter == to_coefficients).values(), at);
        });
    }
}

}  // namespace chiaro
