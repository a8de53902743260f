#include <chiaro/compare.h>
#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "image/ordered_sum.h"
#include "image/ssim.h"

namespace chiaro {
namespace {

/// What differences add up to.
struct Differences {
    double squares = 0, sum = 0, max = 0;

    void add(double difference) {
        squares += difference * difference;
        sum += difference;
        max = std::max(max, std::abs(difference));
    }
    Differences operator+(const Differences& o) const {
        return {squares + o.squares, sum + o.sum, std::max(max, o.max)};
    }
};

void check_finite(double sum) {
    if (!std::isfinite(sum)) throw Error(ErrorCode::input, "values that are not finite numbers cannot be compared");
}

bool is_opaque(const Frame& frame) {
    for (std::size_t i = 3; i < frame.rgba.size(); i += 4)
        if (frame.rgba[i] != 1) return false;
    return true;
}

/// Values taken at a time: enough to hide the calls, few enough for the first cache.
constexpr std::int64_t block = 2048;
using Block = std::array<double, block>;

std::int64_t value_count(const Volume& volume) { return std::int64_t(volume.voxel_count()) * volume.components; }

/// The values [first, first + count), after slope and intercept.
void read(const Volume& volume, std::int64_t first, std::int64_t count, Block& values) {
    with_voxel_type(volume.type, [&](auto type) {
        const auto stored = volume.as<decltype(type)>();
        for (std::int64_t i = 0; i < count; ++i)
            values[i] = volume.slope * double(stored[first + i]) + volume.intercept;
    });
}

/// Sums up visit(sum, a, b) over all pairs of values.
template <class Sum, class Visit>
Sum sum_of_pairs(const Volume& a, const Volume& b, const Visit& visit) {
    const std::int64_t values = value_count(a);
    return ordered_sum((values + block - 1) / block, [&](std::int64_t part) {
        const std::int64_t first = part * block, count = std::min(block, values - first);
        Block of_a, of_b;
        read(a, first, count, of_a), read(b, first, count, of_b);
        Sum sum;
        for (std::int64_t i = 0; i < count; ++i) visit(sum, of_a[i], of_b[i]);
        return sum;
    });
}

struct Means {
    double a = 0, b = 0;
    Means operator+(const Means& o) const { return {a + o.a, b + o.b}; }
};

/// Moments about the means, which a single pass would lose to cancellation.
struct Spread {
    Differences differences;
    double aa = 0, bb = 0, ab = 0;
    Spread operator+(const Spread& o) const { return {differences + o.differences, aa + o.aa, bb + o.bb, ab + o.ab}; }
};

std::string shape_of(const Volume& volume) {
    return fmt::format("{} voxels with {} value{}", fmt::join(volume.dimensions, " x "), volume.components,
                       volume.components > 1 ? "s" : "");
}

}  // namespace

ImageDifference compare(const Frame& a, const Frame& b) {
    if (a.width != b.width || a.height != b.height)
        throw Error(ErrorCode::input, fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared", a.width,
                                                  a.height, b.width, b.height));
    if (a.rgba.empty()) throw Error(ErrorCode::input, "pictures without pixels cannot be compared");
    const int channels = is_opaque(a) && is_opaque(b) ? 3 : 4;
    const auto differences = ordered_sum(a.height, [&](std::int64_t y) {
        Differences row;
        const std::size_t stride = std::size_t(4) * a.width;
        for (std::size_t pixel = y * stride; pixel < (y + 1) * stride; pixel += 4)
            for (std::size_t i = pixel; i < pixel + channels; ++i) row.add(double(b.rgba[i]) - a.rgba[i]);
        return row;
    });
    check_finite(differences.squares);
    const double count = double(channels) * a.width * a.height, rmse = std::sqrt(differences.squares / count);
    return {rmse, -20 * std::log10(rmse), ssim(a, b), differences.max, differences.sum / count};
}

Frame display_values(const Image& image) {
    Frame frame(image.width, image.height);
    const std::size_t channels = image.has_alpha ? 4 : 3;
    for (std::size_t i = 0; i < frame.rgba.size() / 4; ++i) {
        const std::uint8_t* code = &image.pixels[channels * i];
        const float alpha = image.has_alpha ? float(code[3]) / 255 : 1;
        for (int c = 0; c < 3; ++c) frame.rgba[4 * i + c] = float(code[c]) / 255 * alpha;
        frame.rgba[4 * i + 3] = alpha;
    }
    return frame;
}

FieldDifference compare(const Volume& a, const Volume& b) {
    if (a.dimensions != b.dimensions || a.components != b.components)
        throw Error(ErrorCode::input, fmt::format("fields of {} and {} cannot be compared", shape_of(a), shape_of(b)));
    const double count = double(value_count(a));
    const Means sums = sum_of_pairs<Means>(a, b, [](Means& sum, double p, double q) { sum.a += p, sum.b += q; });
    check_finite(sums.a + sums.b);
    const Means means{sums.a / count, sums.b / count};
    const Spread spread = sum_of_pairs<Spread>(a, b, [means](Spread& sum, double p, double q) {
        sum.differences.add(q - p);
        sum.aa += (p - means.a) * (p - means.a);
        sum.bb += (q - means.b) * (q - means.b);
        sum.ab += (p - means.a) * (q - means.b);
    });
    const auto& [squares, sum, max] = spread.differences;
    check_finite(squares);
    return {std::sqrt(squares / count), max, sum / count, spread.ab / std::sqrt(spread.aa * spread.bb)};
}

}  // namespace chiaro
