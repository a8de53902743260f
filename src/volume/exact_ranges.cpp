#include "volume/exact_ranges.h"

#include <chiaro/error.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/threads.h"
#include "volume/brick_curve.h"
#include "volume/fill_brick.h"

namespace chiaro {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Of the box's voxels as a volume stores them; what is not finite makes its bound infinite.
template <class Source>
std::pair<float, float> range_of(const std::vector<Source>& voxels, const DeviceVolume::Data& like) {
    Conversion<Source> conversion;
    if constexpr (std::is_integral_v<Source>)
        conversion.shift = std::numeric_limits<Source>::min();
    else
        conversion.shift = Source(like.shift);
    float low = infinity, high = -infinity;
    bool below = false, above = false;
    for (const Source v : voxels) {
        if constexpr (std::is_floating_point_v<Source>) {
            if (!std::isfinite(v)) {
                (v > 0 ? above : below) = true;
                continue;
            }
            low = std::min(low, v - conversion.shift), high = std::max(high, v - conversion.shift);
        } else {
            const auto stored = float(convert<std::make_unsigned_t<Source>>(v, conversion));
            low = std::min(low, stored), high = std::max(high, stored);
        }
    }
    return {below ? -infinity : low, above ? infinity : high};
}

}  // namespace

BrickRanges exact_ranges(const BrickSource& source, const DeviceVolume::Data& like, Progress& progress) {
    const auto& n = source.header().dimensions;
    const std::array<int, 3> bricks{brick_count(n[0]), brick_count(n[1]), brick_count(n[2])};
    const std::int64_t count = std::int64_t(bricks[0]) * bricks[1] * bricks[2];
    BrickRanges ranges{.low = std::vector<float>(std::size_t(count)), .high = std::vector<float>(std::size_t(count))};
    const auto place_of = [&](std::int64_t b) {
        return std::array{int(b % bricks[0]), int(b / bricks[0] % bricks[1]), int(b / bricks[0] / bricks[1])};
    };
    std::vector<std::int64_t> order(std::size_t(count), 0);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](std::int64_t b) { return place_on_curve(place_of(b)); });
    parallel_for(like.device.threads, count, 1, "ranges", progress, [&](std::int64_t i, std::int64_t) {
        const std::int64_t b = order[std::size_t(i)];
        const std::array<int, 3> at = place_of(b);
        const VoxelBox box = box_of_brick(at, n);
        with_voxel_type(source.header().type, [&](auto zero) {
            using Source = decltype(zero);
            if constexpr (sizeof(Source) <= 2 || std::is_same_v<Source, float>) {
                std::vector<Source> voxels(std::size_t(box.size[0]) * box.size[1] * box.size[2]);
                source.read(0, box, reinterpret_cast<std::byte*>(voxels.data()));
                std::tie(ranges.low[std::size_t(b)], ranges.high[std::size_t(b)]) = range_of(voxels, like);
            }
        });
    });
    progress.check();
    float least = infinity, largest = -infinity;
    for (std::size_t b = 0; b < ranges.low.size(); ++b) {
        if (std::isfinite(ranges.low[b])) least = std::min(least, ranges.low[b]);
        if (std::isfinite(ranges.high[b])) largest = std::max(largest, ranges.high[b]);
    }
    if (!(least <= largest))
        throw Error(ErrorCode::input, "no voxel of " + source.header().source + " is a finite number");
    for (std::size_t b = 0; b < ranges.low.size(); ++b) {
        ranges.low[b] = std::clamp(ranges.low[b], least, largest);
        ranges.high[b] = std::clamp(ranges.high[b], least, largest);
    }
    ranges.least = least, ranges.largest = largest;
    return ranges;
}

}  // namespace chiaro
