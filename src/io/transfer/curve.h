// Colour and opacity while they are still apart: piecewise linear over the value axis.
#pragma once
#include <chiaro/transfer_function.h>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace chiaro {

template <std::size_t N>
struct CurveNode {
    double x;
    std::array<double, N> y;
    bool operator==(const CurveNode&) const = default;
};

/// x not falling; constant outside; two nodes of one x are a step.
template <std::size_t N>
using Curve = std::vector<CurveNode<N>>;
using ColorCurve = Curve<3>;
using OpacityCurve = Curve<1>;

/// How VTK bends what lies between two nodes: the mean of both is reached at the share `midpoint` of the way, and
/// `sharpness` leads from a straight line (0) to a step at the midpoint (1).
struct Bend {
    double midpoint = 0.5, sharpness = 0;
};

/// The way from 0 to 1 that has been gone at the share u, after midpoint and sharpness (vtkPiecewiseFunction).
double bent(double u, const Bend& bend);

/// A point between two nodes, s from 0 (the first) to 1.
template <std::size_t N>
using Mix = std::function<std::array<double, N>(double s)>;

/// Appends `to` behind the last node of the curve, and before it as many nodes as it takes for straight lines to stay
/// within `transfer_sampling_error` of mix(bent(u)) in every component, 1024 at most.
template <std::size_t N>
void append_bent(Curve<N>& curve, const CurveNode<N>& to, const Bend& bend, const Mix<N>& mix);

/// The same with both ends mixed component by component.
void append_linear(OpacityCurve& curve, const CurveNode<1>& to, const Bend& bend);

/// One list of both: a point wherever either has one, with the other's value there. Exact, as both are piecewise
/// linear (spec viewer, section 5). Steps stay steps.
std::vector<ControlPoint> united(const ColorCurve& color, const OpacityCurve& opacity);

/// Makes everything outside [low, high] transparent, with steps at the two. Infinite bounds do nothing.
void mask(std::vector<ControlPoint>& points, double low, double high);

/// Points at both ends of a domain, so that a window moves the domain rather than what happens to be first and last.
void span_domain(std::vector<ControlPoint>& points, double low, double high);

/// What a colour map without opacities gets, as our own do: 0 over the lowest tenth, then rising to a quarter.
OpacityCurve color_map_opacity(double low, double high);

}  // namespace chiaro
