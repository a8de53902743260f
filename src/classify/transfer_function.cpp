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

}  // namespace

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
    return tf;
}

}  // namespace chiaro
