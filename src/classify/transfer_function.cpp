#include <chiaro/error.h>
#include <chiaro/transfer_function.h>

#include <algorithm>
#include <cmath>

#include "core/share.h"
#include "core/text.h"

namespace chiaro {
namespace {

[[noreturn]] void refuse(const TransferFunction& tf, const std::string& what) {
    throw Error(ErrorCode::input, "transfer function" + (tf.name.empty() ? "" : " '" + tf.name + "'") + ": " + what);
}

void require_unit_range(const TransferFunction& tf, const std::string& what, double number) {
    if (!(number >= 0 && number <= 1)) refuse(tf, what + " is " + to_text(number) + ": must be in [0, 1]");
}

void validate_point(const TransferFunction& tf, std::size_t i) {
    const ControlPoint& point = tf.points[i];
    const std::string name = "points[" + std::to_string(i) + "]";
    if (!std::isfinite(point.value)) refuse(tf, name + ".value is " + to_text(point.value) + ": must be finite");
    for (double component : point.rgb) require_unit_range(tf, name + ".rgb", component);
    require_unit_range(tf, name + ".opacity", point.opacity);
    if (i > 0 && point.value < tf.points[i - 1].value)
        refuse(tf, name + ".value is " + to_text(point.value) + ": must not fall below the " +
                       to_text(tf.points[i - 1].value) + " before it");
}

void validate_gradient(const TransferFunction& tf) {
    for (std::size_t i = 0; i < tf.gradient.size(); ++i) {
        const GradientPoint& point = tf.gradient[i];
        const std::string name = "gradient_opacity[" + std::to_string(i) + "]";
        if (!(point.magnitude >= 0 && std::isfinite(point.magnitude)))
            refuse(tf, name + ".magnitude is " + to_text(point.magnitude) + ": must be finite and not below 0");
        require_unit_range(tf, name + ".opacity", point.opacity);
        if (i > 0 && point.magnitude < tf.gradient[i - 1].magnitude)
            refuse(tf, name + ".magnitude is " + to_text(point.magnitude) + ": must not fall below the " +
                           to_text(tf.gradient[i - 1].magnitude) + " before it");
    }
    for (std::size_t i = 0; i < tf.widgets.size(); ++i) {
        const GradientWidget& widget = tf.widgets[i];
        const std::string name = "widgets[" + std::to_string(i) + "]";
        const auto rises = [](double low, double high) {
            return std::isfinite(low) && std::isfinite(high) && low < high;
        };
        if (!rises(widget.value_low, widget.value_high))
            refuse(tf, name + ".value: must rise from the first to the second");
        if (!rises(widget.magnitude_low, widget.magnitude_high) || widget.magnitude_low < 0)
            refuse(tf, name + ".magnitude: must rise from the first to the second, neither below 0");
        require_unit_range(tf, name + ".opacity", widget.opacity);
    }
}

void validate_grid(const TransferFunction& tf) {
    const GradientGrid& grid = tf.grid;
    if (grid.columns == 0 && grid.rows == 0 && grid.rgba.empty()) return;
    if (grid.columns < 1 || grid.rows < 1 || grid.rgba.size() != std::size_t(grid.columns) * grid.rows)
        refuse(tf,
               "grid: has " + std::to_string(grid.rgba.size()) + " colours, where its columns times rows are needed");
    const auto rises = [](double low, double high, int count) {
        return std::isfinite(low) && std::isfinite(high) && (low < high || count == 1);
    };
    if (!rises(grid.value_low, grid.value_high, grid.columns) ||
        !rises(grid.magnitude_low, grid.magnitude_high, grid.rows) || grid.magnitude_low < 0)
        refuse(tf, "grid: its values and magnitudes must rise, and no magnitude be below 0");
    for (const auto& rgba : grid.rgba)
        for (const float component : rgba) require_unit_range(tf, "grid", component);
}

/// Of `count` points from low to high the one at or before a number, and the share of the way to the next.
std::pair<int, double> place_among(int count, double low, double high, double number) {
    const double at = count > 1 ? std::clamp((number - low) / (high - low), 0.0, 1.0) * (count - 1) : 0;
    const int first = std::min(int(at), std::max(count - 2, 0));
    return {first, at - first};
}

/// What is left of the extinction that a value's largest opacity has.
double by_grid(const TransferFunction& tf, double value, double magnitude) {
    constexpr double most = 1 - 1e-7;  // as the optical table has it
    const double largest = std::min(evaluate(tf, value).opacity, most);
    if (tf.grid.rgba.empty() || !(largest > 0)) return 1;
    const double here = std::min(evaluate(tf.grid, value, magnitude)[3], most);
    return std::min(std::log1p(-here) / std::log1p(-largest), 1.0);
}

double by_magnitude(const std::vector<GradientPoint>& points, double magnitude) {
    if (points.empty()) return 1;
    const auto above = std::upper_bound(points.begin(), points.end(), magnitude,
                                        [](double m, const GradientPoint& p) { return m < p.magnitude; });
    if (above == points.begin() || above == points.end())
        return above == points.begin() ? points.front().opacity : points.back().opacity;
    return std::lerp(above[-1].opacity, above->opacity,
                     share_between(above[-1].magnitude, above->magnitude, magnitude));
}

double within(const GradientWidget& w, double value, double magnitude) {
    if (value < w.value_low || value > w.value_high || magnitude < w.magnitude_low || magnitude > w.magnitude_high)
        return 0;
    if (w.shape == WidgetShape::rectangle) return w.opacity;
    const double half = (w.value_high - w.value_low) / 2, x = (value - w.value_low) / half - 1;
    if (w.shape == WidgetShape::triangle) {
        const double width = magnitude / w.magnitude_high;
        return width > 0 ? w.opacity * std::max(0.0, 1 - std::abs(x) / width) : 0;
    }
    const double y = 2 * (magnitude - w.magnitude_low) / (w.magnitude_high - w.magnitude_low) - 1;
    return w.opacity * std::max(0.0, 1 - x * x - y * y);
}

}  // namespace

double extinction_factor(const TransferFunction& tf, double value, double magnitude) {
    double shown = tf.widgets.empty() ? 1 : 0;
    for (const GradientWidget& widget : tf.widgets) shown = std::max(shown, within(widget, value, magnitude));
    return shown * by_magnitude(tf.gradient, magnitude) * by_grid(tf, value, magnitude);
}

std::array<double, 4> evaluate(const GradientGrid& grid, double value, double magnitude) {
    const auto [column, x] = place_among(grid.columns, grid.value_low, grid.value_high, value);
    const auto [row, y] = place_among(grid.rows, grid.magnitude_low, grid.magnitude_high, magnitude);
    const std::size_t first = std::size_t(row) * grid.columns + column, right = grid.columns > 1 ? 1 : 0,
                      below = grid.rows > 1 ? std::size_t(grid.columns) : 0;
    std::array<double, 4> rgba;
    for (std::size_t c = 0; c < 4; ++c) {
        const auto at = [&](std::size_t i) { return double(grid.rgba[i][c]); };
        rgba[c] = std::lerp(std::lerp(at(first), at(first + right), x),
                            std::lerp(at(first + below), at(first + below + right), x), y);
    }
    return rgba;
}

TransferFunction over_gradient(GradientGrid grid) {
    TransferFunction tf;
    for (int column = 0; column < grid.columns; ++column) {
        const double share = grid.columns > 1 ? double(column) / (grid.columns - 1) : 0;
        ControlPoint point{std::lerp(grid.value_low, grid.value_high, share), {}, 0};
        std::array<double, 3> even{};
        double sum = 0;
        for (std::size_t i = std::size_t(column); i < grid.rgba.size(); i += std::size_t(grid.columns)) {
            const auto& [r, g, b, opacity] = grid.rgba[i];
            const std::array<float, 3> rgb{r, g, b};
            point.opacity = std::max(point.opacity, double(opacity)), sum += opacity;
            for (std::size_t c = 0; c < 3; ++c) point.rgb[c] += opacity * rgb[c], even[c] += rgb[c] / grid.rows;
        }
        for (std::size_t c = 0; c < 3; ++c) point.rgb[c] = std::clamp(sum > 0 ? point.rgb[c] / sum : even[c], 0.0, 1.0);
        tf.points.push_back(point);
    }
    tf.grid = std::move(grid);
    validate(tf);
    return tf;
}

ControlPoint evaluate(const TransferFunction& tf, double value) {
    const auto& points = tf.points;
    const auto above = std::upper_bound(points.begin(), points.end(), value,
                                        [](double v, const ControlPoint& p) { return v < p.value; });
    const ControlPoint& left = above == points.begin() ? points.front() : above[-1];
    ControlPoint result{value, left.rgb, left.opacity};
    if (above != points.begin() && above != points.end()) {
        const double t = share_between(left.value, above->value, value);  // left.value <= value < above->value
        for (int c = 0; c < 3; ++c) result.rgb[c] = std::lerp(left.rgb[c], above->rgb[c], t);
        result.opacity = std::lerp(left.opacity, above->opacity, t);
    }
    return result;
}

void validate(const TransferFunction& tf) {
    if (tf.points.empty()) refuse(tf, "has no points: must have at least one");
    for (std::size_t i = 0; i < tf.points.size(); ++i) validate_point(tf, i);
    validate_gradient(tf);
    validate_grid(tf);
    if (!(tf.opacity_unit > 0 && std::isfinite(tf.opacity_unit)))
        refuse(tf, "opacity unit is " + to_text(tf.opacity_unit) + ": must be greater than 0");
}

TransferFunction with_window(TransferFunction tf, double center, double width) {
    if (!std::isfinite(center)) throw Error(ErrorCode::usage, "window centre " + to_text(center) + ": must be finite");
    if (!(width > 0 && std::isfinite(width)))
        throw Error(ErrorCode::usage, "window width " + to_text(width) + ": must be greater than 0");
    if (tf.points.empty()) return tf;
    const double first = tf.points.front().value, last = tf.points.back().value;
    for (ControlPoint& point : tf.points)  // a function of one value only is moved, not stretched
        point.value = last > first ? center + (share_between(first, last, point.value) - 0.5) * width : center;
    // Values that are stretched rise as much more steeply.
    if (!(last > first)) return tf;
    const double stretch = width / (last - first);
    for (GradientPoint& point : tf.gradient) point.magnitude *= stretch;
    const auto stretch_box = [&](auto& box) {
        for (double* value : {&box.value_low, &box.value_high})
            *value = center + (share_between(first, last, *value) - 0.5) * width;
        box.magnitude_low *= stretch, box.magnitude_high *= stretch;
    };
    for (GradientWidget& widget : tf.widgets) stretch_box(widget);
    if (!tf.grid.rgba.empty()) stretch_box(tf.grid);
    return tf;
}

}  // namespace chiaro
