// The coefficients of B-splines, and voxels as B-splines smooth them: one layer of bricks at a time.
#include "volume/splined.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <tuple>

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// Slices beyond a layer's own that its coefficients are found with: one depends on a voxel k away by .27^k.
constexpr int apron = 12;

/// n rows of `lanes` numbers, `stride` numbers apart, as the lines of one axis: lane by lane.
struct Lines {
    float* first;
    std::ptrdiff_t stride;
    int n, lanes;
    float* row(int i) const { return first + i * stride; }
};

/// The numbers c with (c[i - 1] + 4 c[i] + c[i + 1]) / 6 = v[i], straight on at both ends (a natural spline, which
/// reproduces linear ramps): by elimination (Thomas).
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

/// (v[i - 1] + 4 v[i] + v[i + 1]) / 6; beyond the ends the last voxel stands.
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

using Filter = void (*)(const Lines&);

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

/// Calls visit(brick, where) for each brick of the filtered voxels.
template <class Visit>
void for_each_brick(const DeviceVolume::Data& source, Filter filter, const Progress& progress, const Visit& visit) {
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

/// Smallest and largest of all.
std::pair<float, float> range_of(const DeviceVolume::Data& source, Filter filter, const Progress& progress) {
    std::pair range(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
    std::mutex merging;
    for_each_brick(source, filter, progress, [&](const std::vector<float>& values, const std::array<int, 3>&) {
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        const std::lock_guard lock(merging);
        range = {std::min(range.first, *low), std::max(range.second, *high)};
    });
    return range;
}

/// How coefficients are stored: as wide as the voxels, over the range that occurs; the least voxel value, which often
/// is the empty one, exactly.
template <class Voxel>
SplineCoding coding_for(const DeviceVolume::Data& source, const Progress& progress) {
    if constexpr (std::is_floating_point_v<Voxel>) return {};
    constexpr float codes = std::numeric_limits<Voxel>::max();
    const auto [low, high] = range_of(source, to_coefficients, progress);
    SplineCoding coding;
    coding.scale = high > low ? (high - low) / (codes - 1) : 1;
    coding.least = source.stored_min;
    coding.base = std::round((source.stored_min - low) / coding.scale);
    return coding;
}

template <class Voxel>
Voxel coded(float value, const SplineCoding& coding) {
    if constexpr (std::is_floating_point_v<Voxel>) return value;
    const float code = std::round((value - coding.least) / coding.scale) + coding.base;
    return Voxel(std::clamp(code, 0.0f, float(std::numeric_limits<Voxel>::max())));
}

/// The bricks of the filtered voxels, as those of `source` lie.
template <class Voxel>
VoxelBuffer coded_bricks(const DeviceVolume::Data& source, Filter filter, const SplineCoding& coding,
                         const Progress& progress) {
    VoxelBuffer bricks(source.bricks.size());
    const auto [nx, ny, nz] = source.dimensions;
    const std::size_t bricks_x = std::size_t(brick_count(nx)), bricks_y = std::size_t(brick_count(ny));
    const int layers = brick_count(nz);
    if (slices_read(nz, layers - 1) < brick_row)
        bricks.use_small_pages(std::size_t(layers - 1) * bricks_x * bricks_y * brick_voxels * sizeof(Voxel));
    auto* out = reinterpret_cast<Voxel*>(bricks.data());
    for_each_brick(source, filter, progress, [&](const std::vector<float>& values, const std::array<int, 3>& at) {
        const std::size_t brick = (std::size_t(at[2]) * bricks_y + std::size_t(at[1])) * bricks_x + std::size_t(at[0]);
        const auto end = values.begin() + slices_read(source.dimensions[2], at[2]) * brick_slice;
        std::transform(values.begin(), end, out + brick * brick_voxels,
                       [&](float value) { return coded<Voxel>(value, coding); });
    });
    return bricks;
}

/// Between which codes the spline lies in a cell: those of coefficients for knots half as far apart (Lane and
/// Riesenfeld 1980), which bound it about twice as tightly. `corner` is the first of its 7³, `depth` of whose slices are
/// there.
template <class Voxel>
std::pair<float, float> refined_range(const Voxel* corner, int depth) {
    constexpr int n = cell_edge + 3, fine = 2 * n - 3, row = 12;  // a multiple of what vectors hold
    using Row = std::array<float, row>;
    const auto refine = [](const auto& from, int stride, int i, const auto& put) {
        const int k = i / 2 * stride;
        if (i % 2 == 0)
            for (int j = 0; j < row; ++j) put(j, 0.5f * (from[k][j] + from[k + stride][j]));
        else
            for (int j = 0; j < row; ++j)
                put(j, 0.125f * (from[k][j] + from[k + 2 * stride][j]) + 0.75f * from[k + stride][j]);
    };
    std::array<Row, n * fine> planes;  // refined along x, then y
    for (int z = 0; z < n; ++z) {
        std::array<Row, n> rows;
        for (int y = 0; y < n; ++y) {
            const Voxel* c = corner + std::min(z, depth - 1) * brick_slice + y * brick_row;
            for (int i = 0; i < row; ++i) {
                const int k = std::min(i, fine - 1) / 2;
                rows[std::size_t(y)][std::size_t(i)] =
                    std::min(i, fine - 1) % 2 == 0
                        ? 0.5f * (float(c[k]) + float(c[k + 1]))
                        : 0.125f * (float(c[k]) + float(c[k + 2])) + 0.75f * float(c[k + 1]);
            }
        }
        for (int y = 0; y < fine; ++y)
            refine(rows.data(), 1, y, [&](int j, float v) { planes[std::size_t(z * fine + y)][std::size_t(j)] = v; });
    }
    Row low, high;
    low.fill(std::numeric_limits<float>::max()), high.fill(std::numeric_limits<float>::lowest());
    for (int z = 0; z < fine; ++z)
        for (int y = 0; y < fine; ++y)
            refine(planes.data() + y, fine, z, [&](int j, float v) {
                low[std::size_t(j)] = std::min(low[std::size_t(j)], v);
                high[std::size_t(j)] = std::max(high[std::size_t(j)], v);
            });
    return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

/// What values the spline can have in each cell, in stored units, rounding included; those of its voxels too.
template <class Voxel>
void find_cells(DeviceVolume::Data& data) {
    constexpr int margin = 1;
    constexpr float worth = 1.0f / 64;  // of all values: a range that is so much wider than its voxels' is refined
    const auto [nx, ny, nz] = data.dimensions;
    const int bricks_x = brick_count(nx), bricks_y = brick_count(ny);
    const kernel::VolumeView<Voxel> volume = view_of<Voxel>(data);
    const kernel::SplineView<Voxel>& view = volume.spline;
    const float wider = worth * (data.stored_max - data.stored_min);
    CellRanges codes = data.cells;
    parallel_for(
        data.device.threads, std::int64_t(bricks_x) * bricks_y * brick_count(nz), 1, [&](std::int64_t b, std::int64_t) {
            const std::array<int, 3> at{int(b % bricks_x), int(b / bricks_x % bricks_y),
                                        int(b / (std::int64_t(bricks_x) * bricks_y))};
            const Voxel* brick = view.coefficients + std::size_t(b) * brick_voxels;
            const int slices = slices_read(nz, at[2]);
            fill_cells(volume.voxels + std::size_t(b) * brick_voxels, at, slices, data.cells);
            fill_cells<Voxel, margin>(brick, at, slices, codes);
            for_each_cell(at, codes.count, [&](std::size_t cell, const std::array<int, 3>& first) {
                float &low = data.cells.low[cell], &high = data.cells.high[cell];
                kernel::Two<float> range{codes.low[cell], codes.high[cell]};
                if (view.stored(range.a) < low - wider || view.stored(range.b) > high + wider) {
                    const Voxel* corner = brick + (first[2] - margin) * brick_slice +
                                          (first[1] - margin) * brick_row + first[0] - margin;
                    std::tie(range.a, range.b) = refined_range(corner, slices - first[2] + margin);
                }
                range = view.stored(range);
                low = std::min(low, range.a), high = std::max(high, range.b);
            });
        });
}

template <class Voxel>
void fill(const DeviceVolume::Data& source, bool interpolates, const Progress& progress, DeviceVolume::Data& made) {
    const auto borrowed = [&] { return VoxelBuffer::borrow(source.bricks.data(), source.bricks.size(), nullptr); };
    if (interpolates) {
        made.spline = coding_for<Voxel>(source, progress);
        made.coefficients = coded_bricks<Voxel>(source, to_coefficients, made.spline, progress);
        made.bricks = borrowed();
    } else {
        made.bricks = coded_bricks<Voxel>(source, smooth, {}, progress);
        made.coefficients = borrowed();
    }
    find_cells<Voxel>(made);
}

}  // namespace

DeviceVolume splined(const DeviceVolume& volume, bool interpolates, const Progress& progress) {
    const auto source = volume.data().shared_from_this();
    DeviceVolume::Splines& splines = source->splines;
    const std::lock_guard lock(splines.mutex);
    auto& kept = interpolates ? splines.interpolating : splines.smoothing;
    if (!kept) {
        auto made = std::make_shared<DeviceVolume::Data>();
        made->device = source->device, made->dimensions = source->dimensions, made->geometry = source->geometry;
        made->stored = source->stored, made->scale = source->scale, made->offset = source->offset;
        made->whole_numbers = source->whole_numbers, made->cells = source->cells;
        made->stored_min = source->stored_min, made->stored_max = source->stored_max;
        made->source = source.get();
        with_stored_voxel(*source,
                          [&](auto zero) { fill<decltype(zero)>(*source, interpolates, progress, *made); });
        kept = made;
    }
    return DeviceVolume({source, kept.get()});
}

}  // namespace chiaro
