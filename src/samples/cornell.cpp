// The Cornell box of Ropinski et al. 2008 (figure 5): each material has its own value, so that the transfer function
// alone decides on the colours that bleed.
#include <cmath>

#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr int air = 0, white_wall = 40, red_wall = 80, green_wall = 120, white_box = 160, blue_sphere = 200;
constexpr double wall = 3.0 / 128;  // thickness; the side towards -y is open

/// The box stands on the floor, turned by 17 degrees as in the Cornell box of 1984.
bool in_box(Vec3 p) {
    constexpr double half_width = 0.15, top = 0.58, cosine = 0.956304756, sine = 0.292371705;
    const double x = p.x - 0.34, y = p.y - 0.64;
    return p.z < top && std::abs(cosine * x + sine * y) < half_width && std::abs(cosine * y - sine * x) < half_width;
}

bool in_sphere(Vec3 p) {
    constexpr double radius = 0.165;
    return length(p - Vec3{0.68, 0.36, wall + radius}) < radius;
}

int material(Vec3 p) {
    if (p.x < wall) return red_wall;
    if (p.x > 1 - wall) return green_wall;
    if (p.y > 1 - wall || p.z < wall || p.z > 1 - wall) return white_wall;
    if (in_box(p)) return white_box;
    return in_sphere(p) ? blue_sphere : air;
}

SampleVoxels make_cornell(int size) {
    return generate<std::uint8_t>([=](int i, int j, int k) { return material(in_unit_cube(i, j, k, size)); });
}

TransferFunction cornell_transfer_function() {
    constexpr struct {
        int value;
        Rgb rgb;
    } materials[] = {{white_wall, {0.87, 0.86, 0.83}},
                     {red_wall, {0.75, 0.16, 0.13}},
                     {green_wall, {0.20, 0.60, 0.20}},
                     {white_box, {0.90, 0.89, 0.87}},
                     {blue_sphere, {0.20, 0.35, 0.85}}};
    TransferFunction tf;
    for (const auto& [value, rgb] : materials) {  // a box of ±15 about each value
        tf.points.push_back({value - 15.0, rgb, 0});
        tf.points.push_back({value - 15.0, rgb, 1});
        tf.points.push_back({value + 15.0, rgb, 1});
        tf.points.push_back({value + 15.0, rgb, 0});
    }
    return tf;
}

}  // namespace

Sample cornell_sample() {
    return {{"cornell", "box with coloured walls, a white box and a blue sphere (Ropinski 2008), open towards -y", 128,
             true},
            make_cornell,
            cornell_transfer_function};
}

}  // namespace chiaro
