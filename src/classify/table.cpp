#include <algorithm>
#include <cmath>
#include <limits>

#include "classify/medium.h"
#include "core/srgb.h"

namespace chiaro {
namespace {

constexpr double table_intervals = 4096;

/// The stored values between which the function changes, within those that occur.
std::pair<double, double> changing_range(const DeviceVolume::Data& volume, const TransferFunction& tf,
                                         const Shape& shape) {
    double low = tf.points.front().value, high = tf.points.back().value;
    for (double bound : {shape.threshold_low, shape.threshold_high})
        if (std::isfinite(bound)) low = std::min(low, bound), high = std::max(high, bound);
    if (volume.scale == 0) return {volume.stored_min, volume.stored_min};  // all voxels have one value
    double a = (low - volume.offset) / volume.scale, b = (high - volume.offset) / volume.scale;
    if (a > b) std::swap(a, b);
    const double min = volume.stored_min, max = volume.stored_max;
    return {std::clamp(a, min, max), std::clamp(b, min, max)};
}

OpticalTable::Entry optical_entry(const TransferFunction& tf, const Shape& shape, double value, double unit_mm) {
    const ControlPoint p = evaluate(tf, value);
    const bool outside = value < shape.threshold_low || value > shape.threshold_high;
    const double opacity = outside ? 0 : std::min(p.opacity, 1 - 1e-7);
    const auto channel = [&](double c) { return composited_color(c, tf.rgb_space, shape.color); };
    // κ = -ln(1 - α) / reference length
    return {channel(p.rgb[0]), channel(p.rgb[1]), channel(p.rgb[2]),
            float(-std::log1p(-opacity) / unit_mm * shape.opacity_scale)};
}

}  // namespace

float composited_color(double c, RgbSpace space, ColorMode mode) {
    if (mode == ColorMode::linear && space == RgbSpace::srgb) return float(linear_from_srgb(c));
    if (mode == ColorMode::display && space == RgbSpace::linear) return float(srgb_from_linear(c));
    return float(c);
}

OpticalTable make_optical_table(const DeviceVolume::Data& volume, const TransferFunction& tf, const Shape& shape) {
    auto [low, high] = changing_range(volume, tf, shape);
    double per_unit = 1;
    if (volume.whole_numbers) {
        low = std::floor(low), high = std::ceil(high);
        per_unit = std::exp2(std::floor(std::log2(table_intervals / std::max(1.0, high - low))));
    } else if (high > low) {
        // Where the function changes in less than floats tell apart, it jumps.
        per_unit = table_intervals / std::max({high - low, 1e-9 * std::max(std::abs(low), std::abs(high)), 1e-34});
    }
    // One entry more on either side stands for everything beyond.
    const int count = int(std::ceil((high - low) * per_unit)) + 3;
    OpticalTable table;
    table.index_scale = per_unit;
    table.index_offset = 1 - low * per_unit;
    const double unit_mm = tf.opacity_unit * (tf.opacity_unit_is_mm ? 1 : volume.geometry.smallest_spacing_mm());
    table.unit_mm = unit_mm;
    table.entries.reserve(count);
    // The outermost entries may stand for more than the largest double.
    constexpr double most = std::numeric_limits<double>::max();
    for (int j = 0; j < count; ++j) {
        const double value = volume.scale * (j - table.index_offset) / per_unit + volume.offset;
        table.entries.push_back(optical_entry(tf, shape, std::clamp(value, -most, most), unit_mm));
    }
    return table;
}

}  // namespace chiaro
