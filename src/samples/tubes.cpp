// After Ritschel 2007: coloured translucent bodies throw their shadows onto a plate and into a hollow tube.
//
// Where matter meets air the interpolated value passes through all that lies between. So the materials lie close
// together at the upper end, and the translucent ones below the opaque ones: a surface shows at most a tenth of a voxel
// of another material.
#include <cmath>

#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr double red_ball = 225, blue_bar = 232, yellow_pane = 239, tube = 247, plate = 255;

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
    const auto body = [=](double material, double depth) { return material * coverage(depth * size); };
    return std::max({body(plate, depth_in_box(p, {0.05, 0.05, 0.05}, {0.95, 0.95, 0.11})),
                     body(tube, depth_in_tube(p, 0.42, 0.30, 0.155, 0.19, 0.22, 0.70)),
                     body(red_ball, depth_in_ball(p, {0.80, 0.56, 0.55}, 0.10)),
                     body(blue_bar, depth_in_tube(p, 0.76, 0.50, 0, 0.045, 0.15, 0.75)),
                     body(yellow_pane, depth_in_box(p, {0.80, 0.16, 0.11}, {0.83, 0.44, 0.50}))});
}

Volume make(int size) {
    return generate<std::uint8_t>(size,
                                  [=](int i, int j, int k) { return value(in_unit_cube(i, j, k, size), size) + 0.5; });
}

TransferFunction transfer_function() {
    constexpr struct {
        double value;
        Rgb rgb;
        double opacity;
    } materials[] = {{red_ball, {0.90, 0.15, 0.12}, 0.15},
                     {blue_bar, {0.15, 0.35, 0.95}, 0.15},
                     {yellow_pane, {0.98, 0.80, 0.10}, 0.15},
                     {tube, {0.92, 0.90, 0.86}, 0.9},
                     {plate, {0.85, 0.85, 0.85}, 0.9}};
    TransferFunction tf;
    tf.points = {{red_ball - 5, materials[0].rgb, 0}};
    for (const auto& [value, rgb, opacity] : materials) {
        tf.points.push_back({value - 3, rgb, opacity});
        tf.points.push_back({value + 3, rgb, opacity});
    }
    return tf;
}

}  // namespace

Sample tubes_sample() {
    return {
        {"tubes", "a hollow tube that coloured shadows fall into (after Ritschel 2007)", 128}, make, transfer_function};
}

}  // namespace chiaro
