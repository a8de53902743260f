#include <chiaro/error.h>
#include <chiaro/measuring.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

constexpr std::int64_t bricks_at_a_time = 16;

/// The rows of voxels of a volume, each with the squared length of its gradients in stored units per mm.
template <class Voxel>
class Gradients {
public:
    explicit Gradients(const DeviceVolume::Data& volume)
        : n_(volume.dimensions), voxels_(reinterpret_cast<const Voxel*>(volume.bricks.data())) {
        // A gradient is a covector: its axes in the world are those of the voxels per mm; the half is the difference's.
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 along;
            along[axis] = 1;
            const Vec3 row = 0.5 * volume.geometry.voxel_from_world_vector(along);
            for (int k = 0; k < 3; ++k) world_[axis][k] = float(row[k]);
        }
    }

    std::int64_t bricks() const { return std::int64_t(brick_count(n_[0])) * brick_count(n_[1]) * brick_count(n_[2]); }

    /// Calls f(voxels, squared lengths, count) for each row of a brick. The last voxel of an axis is the last brick's.
    template <class Function>
    void for_rows(std::int64_t brick, Function&& f) const {
        const int bx = brick_count(n_[0]), by = brick_count(n_[1]);
        const std::array<int, 3> first{int(brick % bx) * brick_edge, int(brick / bx % by) * brick_edge,
                                       int(brick / bx / by) * brick_edge};
        std::array<int, 3> count{};
        for (int axis = 0; axis < 3; ++axis) {
            const int left = n_[axis] - first[axis];
            count[axis] = left <= brick_edge + 1 ? left : brick_edge;
        }
        std::array<float, brick_edge + 1> squares{};
        for (int z = 0; z < count[2]; ++z)
            for (int y = 0; y < count[1]; ++y) {
                const Voxel* const row = voxels_ + std::size_t(brick) * brick_voxels +
                                         ((z + brick_before) * brick_row + y + brick_before) * brick_row + brick_before;
                for (int x = 0; x < count[0]; ++x) squares[std::size_t(x)] = squared(row + x);
                f(row, squares.data(), count[0]);
            }
    }

private:
    float squared(const Voxel* at) const {
        const float dx = float(at[1]) - float(at[-1]), dy = float(at[brick_row]) - float(at[-brick_row]);
        const float dz = float(at[brick_slice]) - float(at[-brick_slice]);
        float sum = 0;
        for (const auto& row : world_) {
            const float along = row[0] * dx + row[1] * dy + row[2] * dz;
            sum += along * along;
        }
        return sum;
    }

    std::array<int, 3> n_;
    const Voxel* voxels_;
    std::array<std::array<float, 3>, 3> world_{};
};

/// Works on all bricks; `found`, what one piece of them came to, is handed to `merge`, one piece at a time.
template <class Voxel, class Found, class Each, class Merge>
void over_bricks(const DeviceVolume::Data& volume, const Gradients<Voxel>& gradients, const Found& none,
                 Progress& progress, const Each& each, const Merge& merge) {
    std::mutex mutex;
    const auto piece = [&](std::int64_t begin, std::int64_t end) {
        Found found = none;
        for (auto brick = begin; brick < end; ++brick)
            gradients.for_rows(brick, [&](const Voxel* voxels, const float* squares, int count) {
                each(found, voxels, squares, count);
            });
        const std::lock_guard lock(mutex);
        merge(found);
    };
    parallel_for(volume.device.threads, gradients.bricks(), bricks_at_a_time, "gradients", progress, piece);
    progress.check();
}

template <class Voxel>
void count(const DeviceVolume::Data& volume, GradientHistogram& told, Progress& progress) {
    const Gradients<Voxel> gradients(volume);
    float steepest = 0;
    over_bricks(
        volume, gradients, 0.0f, progress,
        [](float& most, const Voxel*, const float* squares, int n) {
            most = std::max(most, *std::max_element(squares, squares + n));
        },
        [&](float most) { steepest = std::max(steepest, most); });
    told.steepest = std::abs(volume.scale) * std::sqrt(double(steepest));
    const float per_row = steepest > 0 ? 1 / steepest : 0, last_row = float(told.rows - 1);
    const double range = double(volume.stored_max) - volume.stored_min;
    // Where values fall as stored numbers rise, the least value is the largest number's.
    const double per_column = range > 0 ? (volume.scale < 0 ? -1 : 1) * told.columns / range : 0;
    const double least = volume.scale < 0 ? volume.stored_max : volume.stored_min;
    over_bricks(
        volume, gradients, std::vector<std::uint32_t>(told.counts.size()), progress,
        [&](std::vector<std::uint32_t>& counts, const Voxel* voxels, const float* squares, int n) {
            for (int x = 0; x < n; ++x) {
                const float row = float(told.rows) * std::sqrt(std::sqrt(squares[x] * per_row));
                const double column = std::min((double(voxels[x]) - least) * per_column, told.columns - 1.0);
                ++counts[std::size_t(std::min(last_row, row)) * std::size_t(told.columns) + std::size_t(column)];
            }
        },
        [&](const std::vector<std::uint32_t>& counts) {
            for (std::size_t i = 0; i < counts.size(); ++i) told.counts[i] += counts[i];
        });
}

void check_bins(const char* name, int bins) {
    if (bins < 1 || bins > max_histogram_bins)
        throw Error(ErrorCode::usage, std::string("histogram: ") + name + " must be in 1 to 1024");
}

}  // namespace

GradientHistogram gradient_histogram(const DeviceVolume& volume, int columns, int rows, Progress& progress) {
    check_bins("columns", columns), check_bins("rows", rows);
    const DeviceVolume::Data& data = volume.data();
    GradientHistogram told;
    const double range = double(data.stored_max) - data.stored_min;
    told.columns = data.whole_numbers && range < columns ? int(range) + 1 : columns;
    told.rows = rows;
    const double a = data.value_of(data.stored_min), b = data.value_of(data.stored_max);
    told.value_low = std::min(a, b), told.value_high = std::max(a, b);
    told.counts.resize(std::size_t(told.columns) * std::size_t(rows));
    with_stored_voxel(data, [&](auto voxel) { count<decltype(voxel)>(data, told, progress); });
    return told;
}

}  // namespace chiaro
