// What the values of a volume are. Values of 8 and 16 bits are counted one by one. Others are counted at 65536 levels
// between the least and the greatest, the first level being the least value itself: a second pass.
#include <chiaro/error.h>
#include <chiaro/volume.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

#include "core/threads.h"
#include "volume/noise.h"
#include "volume/validate.h"

namespace chiaro {
namespace {

constexpr std::size_t level_count = 65536;

/// How often each level occurs; level i stands for the value first + i * step, the last one exactly for `last`.
struct Levels {
    std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(level_count);
    double first = 0, step = 1, last = 0;
    /// A power of two, other than 1 where the range or the steps are no doubles: `step` is so many times as large.
    double unit = 1;
    std::uint64_t nonfinite = 0;

    double value_of(std::size_t level) const {
        if (level == level_count - 1) return last;
        return unit == 1 ? first + double(level) * step : (first * unit + double(level) * step) / unit;
    }
};

struct Range {
    double least = std::numeric_limits<double>::infinity(), greatest = -std::numeric_limits<double>::infinity();
};

/// Pieces so large that each thread has one: every piece brings half a megabyte of counters.
std::int64_t grain_of(std::size_t count) { return std::int64_t(count) / usable_threads() + 1; }

/// Calls body(begin, end) for pieces of a millisecond, until cancelled.
void each_millisecond(std::int64_t begin, std::int64_t end, const Progress& progress,
                      const std::function<void(std::int64_t, std::int64_t)>& body) {
    constexpr std::int64_t piece = 1 << 19;
    for (auto first = begin; first < end && !progress.cancelled(); first += piece)
        body(first, std::min(end, first + piece));
}

template <class T>
bool is_finite(T value) {
    if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
    return true;
}

template <class T>
Range range_of(std::span<const T> values, const Progress& progress) {
    Range range;
    std::mutex merging;
    parallel_for(std::int64_t(values.size()), grain_of(values.size()), [&](std::int64_t begin, std::int64_t end) {
        T least = std::numeric_limits<T>::max(), greatest = std::numeric_limits<T>::lowest();
        bool any = false;
        each_millisecond(begin, end, progress, [&](std::int64_t first, std::int64_t last) {
            for (auto i = first; i < last; ++i) {
                const T value = values[std::size_t(i)];
                if (!is_finite(value)) continue;
                any = true;
                least = std::min(least, value);
                greatest = std::max(greatest, value);
            }
        });
        if (!any) return;
        const std::lock_guard lock(merging);
        range.least = std::min(range.least, double(least));
        range.greatest = std::max(range.greatest, double(greatest));
    });
    progress.check();
    return range;
}

/// Counts every value at the level nearest to it.
template <class T>
void count_values(std::span<const T> values, Levels& levels, const Progress& progress) {
    std::mutex merging;
    parallel_for(std::int64_t(values.size()), grain_of(values.size()), [&](std::int64_t begin, std::int64_t end) {
        std::vector<std::uint64_t> counts(level_count);
        std::uint64_t nonfinite = 0;
        const double unit = levels.unit, first = levels.first * unit, per_step = 1 / levels.step;
        const auto count = [&](T value) {
            if constexpr (sizeof(T) <= 2) {
                ++counts[std::size_t(int(value) - int(std::numeric_limits<T>::min()))];
            } else if (is_finite(value)) {
                const double level = std::floor((double(value) * unit - first) * per_step + 0.5);
                ++counts[std::size_t(std::clamp(level, 0.0, double(level_count - 1)))];
            } else {
                ++nonfinite;
            }
        };
        each_millisecond(begin, end, progress, [&](std::int64_t from, std::int64_t to) {
            for (auto i = from; i < to; ++i) count(values[std::size_t(i)]);
        });
        const std::lock_guard lock(merging);
        for (std::size_t i = 0; i < level_count; ++i) levels.counts[i] += counts[i];
        levels.nonfinite += nonfinite;
    });
    progress.check();
}

template <class T>
Levels levels_of(const Volume& volume, const Progress& progress) {
    const std::span<const T> values = volume.as<T>();
    if (values.empty()) throw Error(ErrorCode::input, "the volume has no voxels");
    Levels levels;
    if constexpr (sizeof(T) <= 2) {
        levels.first = double(std::numeric_limits<T>::min());
    } else {
        const Range range = range_of(values, progress);
        if (range.greatest < range.least)
            throw Error(ErrorCode::input, "no voxel of " + volume.source + " is a finite number");
        levels.first = range.least;
        const double width = range.greatest - range.least;
        levels.unit = !std::isfinite(width) ? 0x1p-2 : width > 0 && width < 0x1p-900 ? 0x1p100 : 1;
        // Halved first: the whole range of doubles is no double.
        levels.step =
            2 * ((range.greatest * levels.unit / 2 - range.least * levels.unit / 2) / double(level_count - 1));
        if (std::is_integral_v<T>) levels.step = std::max(1.0, levels.step);
        if (!(levels.step > 0)) levels.step = 1;
        if (!std::is_integral_v<T>) levels.last = range.greatest;
    }
    if (std::is_integral_v<T>) levels.last = levels.first + double(level_count - 1) * levels.step;
    count_values(values, levels, progress);
    return levels;
}

/// Values after slope and intercept; a negative slope turns their order around.
void apply_rescale(Levels& levels, double slope, double intercept) {
    if (slope < 0) {
        std::reverse(levels.counts.begin(), levels.counts.end());
        std::swap(levels.first, levels.last);
        levels.step = -levels.step;
    }
    levels.first = slope * levels.first + intercept;
    levels.last = slope * levels.last + intercept;
    levels.step *= slope;
}

void summarize(const Levels& levels, Statistics& result) {
    const auto occurs = [](std::uint64_t count) { return count > 0; };
    const auto& counts = levels.counts;
    const auto lowest = std::size_t(std::find_if(counts.begin(), counts.end(), occurs) - counts.begin());
    const auto highest = std::size_t(counts.rend() - std::find_if(counts.rbegin(), counts.rend(), occurs)) - 1;
    result.min = levels.value_of(lowest);
    result.max = levels.value_of(highest);
    std::uint64_t total = 0;
    for (const auto count : counts) total += count;
    // The least value that at least the share p of the voxels does not exceed.
    const std::pair<double, double*> percentiles[] = {
        {0.01, &result.p1}, {0.5, &result.p50}, {0.99, &result.p99}, {0.999, &result.p999}};
    std::uint64_t seen = 0;
    std::size_t next = 0;
    for (std::size_t level = lowest; level <= highest; ++level) {
        seen += counts[level];
        for (; next < std::size(percentiles) && double(seen) >= percentiles[next].first * double(total); ++next)
            *percentiles[next].second = levels.value_of(level);
        const double share = result.max > result.min ? double(level - lowest) / double(highest - lowest) : 0;
        result.histogram[std::min<std::size_t>(255, std::size_t(share * 256))] += counts[level];
    }
    result.nonfinite = levels.nonfinite;
}

/// 12 bits from air at 0 or at 24: tissue is where its water then is. Air at 24 has a peak there; noise about 0, or a
/// padding of 0 around the scanner's circle, only falls.
double hu_zero_of(const Volume& volume, const Levels& levels, const Statistics& data) {
    const bool is_whole = volume.type == VoxelType::u16 || volume.type == VoxelType::i16;
    if (!is_whole || volume.slope != 1 || volume.intercept != 0) return 0;
    if (data.min < 0 || data.min > 100 || data.max < 1500 || data.max > 4095) return 0;
    const auto between = [&](double least, double most) {
        double sum = 0;
        for (double value = std::max(least, data.min); value <= std::min(most, data.max); ++value)
            sum += double(levels.counts[std::size_t((value - levels.first) / levels.step)]);
        return sum;
    };
    const double all = between(0, 4095), zero = between(20, 28) / 9 > between(6, 12) / 7 ? 1024 : 1000;
    const double air = between(0, zero - 900), tissue = between(zero - 150, zero + 150);
    const bool is_peak = tissue > between(zero - 450, zero - 150) && tissue > between(zero + 150, zero + 450);
    return air > 0.03 * all && tissue > 0.03 * all && is_peak ? zero : 0;
}

}  // namespace

Statistics measure(const Volume& volume) { return measure(volume, Progress()); }

Statistics measure(const Volume& volume, const Progress& progress) {
    return with_voxel_type(volume.type, [&](auto zero) {
        Levels levels = levels_of<decltype(zero)>(volume, progress);
        apply_rescale(levels, volume.slope, volume.intercept);
        Statistics result;
        summarize(levels, result);
        check_values(volume, result.min, result.max);
        result.hu_zero = hu_zero_of(volume, levels, result);
        constexpr double empty = 0.05;  // of the range: noise of air is no matter
        const double range = result.p999 - result.p1;
        if (range > 0) result.noise = noise_of(volume, result.p1 + empty * range, progress) / range;
        return result;
    });
}

}  // namespace chiaro
