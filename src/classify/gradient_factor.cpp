#include "classify/gradient_factor.h"

#include <algorithm>
#include <cmath>

#include "volume/borrowed.h"

namespace chiaro {
namespace {

/// As fine as single curves need; of both value and gradient 1 MiB.
constexpr int rows_of_curve = 4096, rows_of_both = 512, columns_of_both = 512;

/// Beyond what a function tells apart: one row more.
double largest_magnitude(const TransferFunction& tf) {
    double largest = 0;
    for (const GradientPoint& point : tf.gradient) largest = std::max(largest, point.magnitude);
    for (const GradientWidget& widget : tf.widgets) largest = std::max(largest, widget.magnitude_high);
    if (!tf.grid.rgba.empty()) largest = std::max(largest, tf.grid.magnitude_high);
    return 1.01 * largest;
}

/// Calls f(value, magnitude) for each entry.
template <class Function>
void for_each_entry(const DeviceVolume::Data& volume, const ExtinctionFactor& factor, Function&& f) {
    for (int row = 0; row < factor.rows; ++row)
        for (int column = 0; column < factor.columns; ++column) {
            const double stored =
                factor.columns > 1 ? (column - factor.index_offset) / factor.index_scale : volume.stored_min;
            f(volume.scale * stored + volume.offset, factor.rows_per_unit > 0 ? row / factor.rows_per_unit : 0);
        }
}

/// Colours of a grid, where it has others than the function's points have for the same values.
std::vector<std::array<float, 3>> colors_of(const DeviceVolume::Data& volume, const ExtinctionFactor& factor,
                                            const TransferFunction& tf) {
    constexpr double alike = 1.0 / 512;
    std::vector<std::array<float, 3>> colors;
    if (tf.grid.rgba.empty()) return colors;
    bool differ = false;
    for_each_entry(volume, factor, [&](double value, double magnitude) {
        const std::array<double, 4> rgba = evaluate(tf.grid, value, magnitude);
        const Rgb of_points = evaluate(tf, value).rgb;
        for (std::size_t c = 0; c < 3; ++c)
            differ = differ || (rgba[3] > 0 && std::abs(rgba[c] - of_points[c]) > alike);
        colors.push_back({float(rgba[0]), float(rgba[1]), float(rgba[2])});
    });
    if (!differ) colors.clear();
    return colors;
}

}  // namespace

std::shared_ptr<const ExtinctionFactor> make_factor(const DeviceVolume::Data& volume, const TransferFunction& tf,
                                                    ColorMode color) {
    const bool of_both = !tf.widgets.empty() || !tf.grid.rgba.empty();
    if (tf.gradient.empty() && !of_both) return nullptr;
    auto factor = std::make_shared<ExtinctionFactor>();
    const bool by_value = of_both && volume.stored_max > volume.stored_min;
    const int rows = of_both ? rows_of_both : rows_of_curve;
    const double top = largest_magnitude(tf);
    factor->columns = by_value ? columns_of_both : 1;
    factor->rows = rows;
    factor->rows_per_unit = top > 0 ? (rows - 1) / top : 0;
    if (by_value) {
        factor->index_scale = (columns_of_both - 1) / (double(volume.stored_max) - volume.stored_min);
        factor->index_offset = -volume.stored_min * factor->index_scale;
    }
    for_each_entry(volume, *factor, [&](double value, double magnitude) {
        factor->entries.push_back(float(extinction_factor(tf, value, magnitude)));
    });
    factor->colors = colors_of(volume, *factor, tf);
    for (auto& rgb : factor->colors)
        for (float& c : rgb) c = composited_color(c, tf.rgb_space, color);
    const auto [least, most] = std::minmax_element(factor->entries.begin(), factor->entries.end());
    return *least == 1 && *most == 1 && factor->colors.empty() ? nullptr : factor;
}

DeviceVolume with_factor(const DeviceVolume& volume, std::shared_ptr<const ExtinctionFactor> factor) {
    // Never by shared_from_this: who has a spline keeps the volume that it is of, too.
    const DeviceVolume plain = volume.data().plain ? volume.data().plain : volume;
    if (!factor) return plain;
    auto made = borrowed(plain);
    made->factor = std::move(factor);
    return DeviceVolume(std::move(made));
}

namespace {

/// Along one axis the least or greatest of each cell and so many on both sides.
template <class Better>
void spread(std::vector<float>& of, const std::array<int, 3>& count, int axis, int reach, const Better& better) {
    const std::size_t stride = axis == 0 ? 1 : axis == 1 ? std::size_t(count[0]) : std::size_t(count[0]) * count[1];
    const std::vector<float> from = of;
    for (std::size_t i = 0; i < of.size(); ++i) {
        const int at = int(i / stride % std::size_t(count[axis]));
        for (int d = 1; d <= reach; ++d) {
            if (at >= d) of[i] = better(of[i], from[i - d * stride]);
            if (at + d < count[axis]) of[i] = better(of[i], from[i + d * stride]);
        }
    }
}

/// The greatest gradient that may occur in each cell, in rows of the table.
std::vector<float> largest_rows(const DeviceVolume::Data& volume) {
    std::vector<float> low = volume.cells.low, high = volume.cells.high;
    // Means over thick slices look up to five voxels beyond a cell of four.
    const int reach = volume.normal_reach[0] > 0 ? 2 : 1;
    for (int axis = 0; axis < 3; ++axis) {
        spread(low, volume.cells.count, axis, reach, [](float a, float b) { return std::min(a, b); });
        spread(high, volume.cells.count, axis, reach, [](float a, float b) { return std::max(a, b); });
    }
    double longest = 0;  // that differences of at most ±1 along each axis become in the world
    for (int signs = 0; signs < 8; ++signs) {
        const Vec3 difference{signs & 1 ? 1.0 : -1.0, signs & 2 ? 1.0 : -1.0, signs & 4 ? 1.0 : -1.0};
        Vec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 along;
            along[axis] = 1;
            gradient[axis] = dot(volume.geometry.voxel_from_world_vector(along), difference);
        }
        longest = std::max(longest, length(gradient));
    }
    const double rows = 0.5 * longest * std::abs(volume.scale) * volume.factor->rows_per_unit;
    for (std::size_t i = 0; i < low.size(); ++i) high[i] = float((double(high[i]) - low[i]) * rows * 1.0001);
    return high;
}

/// In each entry the largest of its column's up to its row.
std::vector<float> largest_so_far(const ExtinctionFactor& factor) {
    std::vector<float> largest = factor.entries;
    for (std::size_t i = std::size_t(factor.columns); i < largest.size(); ++i)
        largest[i] = std::max(largest[i], largest[i - std::size_t(factor.columns)]);
    return largest;
}

}  // namespace

std::vector<std::uint8_t> cells_with_factor(const DeviceVolume::Data& volume) {
    const ExtinctionFactor& factor = *volume.factor;
    const std::vector<float> rows = largest_rows(volume), largest = largest_so_far(factor);
    const auto column = [&](float stored, double beyond) {
        const double at = stored * factor.index_scale + factor.index_offset + 0.5 + beyond;
        return std::size_t(std::clamp(at, 0.0, factor.columns - 1.0));
    };
    std::vector<std::uint8_t> left(rows.size());
    for (std::size_t cell = 0; cell < rows.size(); ++cell) {
        const auto row = std::size_t(std::min(double(rows[cell]) + 1, factor.rows - 1.0));
        const float* const first = largest.data() + row * std::size_t(factor.columns);
        // One column more on either side for what rounding may reach.
        left[cell] = std::any_of(first + column(volume.cells.low[cell], -1),
                                 first + column(volume.cells.high[cell], 1) + 1, [](float f) { return f > 0; });
    }
    return left;
}

}  // namespace chiaro
