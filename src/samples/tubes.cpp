// After Ritschel 2007: coloured translucent bodies throw their shadows onto a plate and into a hollow tube.
//
// Air lies in the middle of the range, opaque matter below and translucent matter above it: the interpolated value at
// the surface of an opaque body passes through opaque matter only, and the surface has a ramp for its gradient.
#include <cmath>

#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr double plate = 0, tube = 40, tube_air = 128, yellow_pane = 200, blue_bar = 227, red_ball = 255;

double depth_in_box(Vec3 p, Vec3 low, Vec3 high) {
    double depth = 1;
    for (int axis = 0; axis < 3; ++axis) depth = std::min({depth, p[axis] - low[axis], high[axis] - p[axis]});
    return depth;
}

double depth_in_ball(Vec3 p, Vec3 centre, double radius) { return radius - length(p - centre); }

/// Along x, between x = low and x = high.
double depth_in_tube(Vec3 p, double y, double z, double inner, double outer, double low, double high) {
    const double r = std::hypot(p.y - y, p.z - z);
    return std::min({r - inner, outer - r, p.x - low, high - p.x});
}

double value(Vec3 p, int size) {
    const auto body = [=](double material, double depth) { return (material - tube_air) * coverage(depth * size); };
    const double opaque = std::min(body(plate, depth_in_box(p, {0.05, 0.05, 0.05}, {0.95, 0.95, 0.11})),
                                   body(tube, depth_in_tube(p, 0.42, 0.30, 0.155, 0.19, 0.22, 0.70)));
    const double translucent = std::max({body(red_ball, depth_in_ball(p, {0.80, 0.56, 0.55}, 0.10)),
                                         body(blue_bar, depth_in_tube(p, 0.76, 0.50, 0, 0.045, 0.15, 0.75)),
                                         body(yellow_pane, depth_in_box(p, {0.80, 0.16, 0.11}, {0.83, 0.44, 0.50}))});
    return tube_air + opaque + translucent;
}

SampleVoxels make_tubes(int size) {
    return generate<std::uint8_t>([=](int i, int j, int k) { return value(in_unit_cube(i, j, k, size), size) + 0.5; });
}

TransferFunction tubes_transfer_function() {
    constexpr Rgb white{0.93, 0.91, 0.87}, grey{0.82, 0.83, 0.85}, yellow{1.0, 0.82, 0.10}, blue{0.15, 0.35, 1.0},
        red{0.95, 0.15, 0.10};
    constexpr double opaque = 0.95, translucent = 0.2;
    TransferFunction tf;
    tf.points = {
        {plate, grey, opaque},    {12, grey, opaque},       {28, white, opaque},        {52, white, opaque},
        {100, white, 0},          {160, yellow, 0},         {185, yellow, translucent}, {210, yellow, translucent},
        {217, blue, translucent}, {237, blue, translucent}, {244, red, translucent},    {red_ball, red, translucent}};
    return tf;
}

}  // namespace

Sample tubes_sample() {
    return {{"tubes", "a hollow tube that coloured shadows fall into (after Ritschel 2007)", 128},
            make_tubes,
            tubes_transfer_function};
}

}  // namespace chiaro
