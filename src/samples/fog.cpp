// A soft bank of fog: nowhere a surface, everywhere a gradient. The case that separates methods that only know surfaces
// from those that know media.
#include <array>
#include <cmath>

#include "samples/sample.h"

namespace chiaro {
namespace {

/// A number in [0, 1) for each lattice point and octave.
double lattice(int x, int y, int z, int octave) {
    std::uint32_t h = std::uint32_t(x) * 0x8DA6B343u + std::uint32_t(y) * 0xD8163841u + std::uint32_t(z) * 0xCB1AB31Fu +
                      std::uint32_t(octave) * 0x165667B1u;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return (h ^ (h >> 15)) / 4294967296.0;
}

/// Quintic fade (Perlin 2002): the interpolated noise has continuous second derivatives.
double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

/// Value noise: random values on the integer lattice, smoothly interpolated; in [0, 1).
double value_noise(Vec3 p, int octave) {
    const std::array<int, 3> cell{int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
    const Vec3 t{fade(p.x - cell[0]), fade(p.y - cell[1]), fade(p.z - cell[2])};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        const double weight = (dx ? t.x : 1 - t.x) * (dy ? t.y : 1 - t.y) * (dz ? t.z : 1 - t.z);
        sum += weight * lattice(cell[0] + dx, cell[1] + dy, cell[2] + dz, octave);
    }
    return sum;
}

double smooth_step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// Density in [0, 1] at a point of the unit cube: three octaves of noise, fading to nothing towards the cube's faces.
double density(Vec3 p) {
    double sum = 0, amplitude = 0.5;
    for (int octave = 0; octave < 3; ++octave, amplitude /= 2)
        sum += amplitude * value_noise((4 << octave) * p, octave);
    const double from_centre = length(p - Vec3{0.5, 0.5, 0.5});
    return smooth_step(0.25, 0.7, sum) * (1 - smooth_step(0.15, 0.48, from_centre));
}

SampleVoxels make_fog(int size) {
    return generate<float>([=](int i, int j, int k) { return density(in_unit_cube(i, j, k, size)); });
}

TransferFunction fog_transfer_function() {
    TransferFunction tf;
    tf.points = {{0, {0.75, 0.82, 0.95}, 0}, {0.5, {0.92, 0.93, 0.95}, 0.05}, {1, {1, 0.97, 0.92}, 0.15}};
    return tf;
}

}  // namespace

Sample fog_sample() {
    return {{"fog", "a soft cloud of smooth noise, float in [0, 1]", 128}, make_fog, fog_transfer_function};
}

}  // namespace chiaro
