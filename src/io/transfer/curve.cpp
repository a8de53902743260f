#include "io/transfer/curve.h"

#include <chiaro/transfer_file.h>

#include <algorithm>
#include <cmath>

#include "core/color_map_opacity.h"

namespace chiaro {
namespace {

constexpr int max_halvings = 10;
constexpr int probes = 16;  // of each piece; a kink between two of them is found when the piece is halved

template <std::size_t N>
std::array<double, N> lerp(const std::array<double, N>& a, const std::array<double, N>& b, double t) {
    std::array<double, N> y;
    for (std::size_t c = 0; c < N; ++c) y[c] = std::lerp(a[c], b[c], t);
    return y;
}

template <std::size_t N>
double distance(const std::array<double, N>& a, const std::array<double, N>& b) {
    double most = 0;
    for (std::size_t c = 0; c < N; ++c) most = std::max(most, std::abs(a[c] - b[c]));
    return most;
}

/// Appends the end of the piece from (u0, y0) to (u1, y1), halved until it is straight.
template <std::size_t N>
void append_piece(Curve<N>& curve, const std::function<CurveNode<N>(double)>& at, double u0,
                  const std::array<double, N>& y0, double u1, const CurveNode<N>& end, int halvings) {
    double error = 0;
    for (int i = 1; i < probes && halvings < max_halvings; ++i) {
        const double t = double(i) / probes;
        error = std::max(error, distance(at(std::lerp(u0, u1, t)).y, lerp(y0, end.y, t)));
    }
    if (error <= transfer_sampling_error / 2) {
        curve.push_back(end);
        return;
    }
    const double u = (u0 + u1) / 2;
    const CurveNode<N> middle = at(u);
    append_piece(curve, at, u0, y0, u, middle, halvings + 1);
    append_piece(curve, at, u, middle.y, u1, end, halvings + 1);
}

/// The value just before x (the step at x not yet taken) or from x on.
template <std::size_t N>
std::array<double, N> limit(const Curve<N>& curve, double x, bool before) {
    const auto from = std::lower_bound(curve.begin(), curve.end(), x, [](auto& n, double v) { return n.x < v; });
    const auto behind = std::upper_bound(from, curve.end(), x, [](double v, auto& n) { return v < n.x; });
    if (from != behind) return before ? from->y : behind[-1].y;
    if (from == curve.begin()) return curve.front().y;
    if (from == curve.end()) return curve.back().y;
    return lerp(from[-1].y, from->y, (x - from[-1].x) / (from->x - from[-1].x));
}

}  // namespace

double bent(double u, const Bend& bend) {
    const double midpoint = std::clamp(bend.midpoint, 1e-5, 1 - 1e-5), sharpness = bend.sharpness;
    double s = u < midpoint ? 0.5 * u / midpoint : 0.5 + 0.5 * (u - midpoint) / (1 - midpoint);
    if (sharpness > 0.99) return s < 0.5 ? 0 : 1;
    if (sharpness < 0.01) return s;
    const double power = 1 + 10 * sharpness;
    s = s < 0.5 ? 0.5 * std::pow(2 * s, power) : 1 - 0.5 * std::pow(2 * (1 - s), power);
    // A cubic Hermite piece from 0 to 1 whose slope at both ends is 1 - sharpness.
    const double step = s * s * (3 - 2 * s), slopes = s * (1 - s) * (1 - 2 * s);
    return step + (1 - sharpness) * slopes;
}

template <std::size_t N>
void append_bent(Curve<N>& curve, const CurveNode<N>& to, const Bend& bend, const Mix<N>& mix) {
    const CurveNode<N> from = curve.back();
    const double midpoint = std::clamp(bend.midpoint, 1e-5, 1 - 1e-5);
    const auto x_at = [&](double u) { return std::min(from.x + (to.x - from.x) * u, to.x); };
    if (bend.sharpness > 0.99) {
        curve.insert(curve.end(), {{x_at(midpoint), from.y}, {x_at(midpoint), to.y}, to});
        return;
    }
    const std::function<CurveNode<N>(double)> at = [&](double u) { return CurveNode<N>{x_at(u), mix(bent(u, bend))}; };
    if (midpoint == 0.5) return append_piece(curve, at, 0, from.y, 1, to, 0);
    const CurveNode<N> middle = at(midpoint);  // where the line breaks
    append_piece(curve, at, 0, from.y, midpoint, middle, 1);
    append_piece(curve, at, midpoint, middle.y, 1, to, 1);
}

template void append_bent(Curve<1>&, const CurveNode<1>&, const Bend&, const Mix<1>&);
template void append_bent(Curve<3>&, const CurveNode<3>&, const Bend&, const Mix<3>&);
template void append_bent(Curve<4>&, const CurveNode<4>&, const Bend&, const Mix<4>&);

void append_linear(OpacityCurve& curve, const CurveNode<1>& to, const Bend& bend) {
    const auto from = curve.back().y;
    append_bent<1>(curve, to, bend, [&](double s) { return lerp(from, to.y, s); });
}

std::vector<ControlPoint> united(const ColorCurve& color, const OpacityCurve& opacity) {
    std::vector<double> xs;
    for (const auto& node : color) xs.push_back(node.x);
    for (const auto& node : opacity) xs.push_back(node.x);
    std::sort(xs.begin(), xs.end());
    xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
    std::vector<ControlPoint> points;
    for (double x : xs) {
        const ControlPoint left{x, limit(color, x, true), limit(opacity, x, true)[0]},
            right{x, limit(color, x, false), limit(opacity, x, false)[0]};
        points.push_back(left);
        if (left != right) points.push_back(right);
    }
    return points;
}

void mask(std::vector<ControlPoint>& points, double low, double high) {
    const auto edge = [whole = TransferFunction{points, {}, 1, false, {}}](double x) { return evaluate(whole, x); };
    const auto transparent = [](ControlPoint p) { return p.opacity = 0, p; };
    if (std::isfinite(low)) {
        const ControlPoint at = edge(low);
        const auto kept = std::find_if(points.begin(), points.end(), [&](auto& p) { return p.value > low; });
        points.erase(points.begin(), kept);
        points.insert(points.begin(), {transparent(at), at});
    }
    if (std::isfinite(high)) {
        const auto kept = std::find_if(points.begin(), points.end(), [&](auto& p) { return p.value >= high; });
        const ControlPoint at = kept != points.end() && kept->value == high ? *kept : edge(high);
        points.erase(kept, points.end());
        points.insert(points.end(), {at, transparent(at)});
    }
}

void span_domain(std::vector<ControlPoint>& points, double low, double high) {
    const auto moved = [](ControlPoint p, double value) { return p.value = value, p; };
    if (points.front().value > low) points.insert(points.begin(), moved(points.front(), low));
    if (points.back().value < high) points.push_back(moved(points.back(), high));
}

OpacityCurve color_map_opacity(double low, double high) {
    constexpr double start = ColorMapOpacity::start, highest = ColorMapOpacity::highest;
    if (!(high > low)) return {{low, {highest}}};
    return {{low, {0}}, {low + start * (high - low), {0}}, {high, {highest}}};
}

}  // namespace chiaro
