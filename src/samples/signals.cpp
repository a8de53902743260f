// Two test signals of the literature and of our own: formulas on [-1, 1]³.
#include <cmath>
#include <numbers>
#include <vector>

#include "samples/sample.h"

namespace chiaro {
namespace {

/// Marschner and Lobb 1994, eq. 3, with f_M = 6 and α = 1/4; in [0, 1]. Needs at least 40 voxels an axis.
SampleVoxels make_marschner_lobb(int size) {
    return generate<float>([=](int i, int j, int k) {
        constexpr double f_m = 6, alpha = 0.25, pi = std::numbers::pi;
        const double x = in_signed_range(i, size), y = in_signed_range(j, size), z = in_signed_range(k, size);
        const double rho = std::cos(2 * pi * f_m * std::cos(pi * std::sqrt(x * x + y * y) / 2));
        return (1 - std::sin(pi * z / 2) + alpha * (1 + rho)) / (2 * (1 + alpha));
    });
}

TransferFunction marschner_lobb_transfer_function() {
    TransferFunction tf;  // about the isosurface 0.5 that the paper shows
    tf.points = {{0.45, {0.20, 0.45, 0.70}, 0}, {0.50, {0.85, 0.80, 0.65}, 0.8}, {1.0, {0.95, 0.90, 0.80}, 0.9}};
    return tf;
}

/// White noise in [0, 1) from the index of a voxel.
double noise(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    std::uint32_t h = x * 0x9E3779B1u ^ (y * 0x85EBCA77u + 0x7F4A7C15u) ^ (z * 0xC2B2AE3Du + 0x165667B1u);
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    h ^= h >> 16;
    return h / 4294967296.0;
}

/// The waves that make the shells wobble are products of functions of one coordinate: two tables an axis.
struct Wave {
    std::vector<double> x, coarse, fine;
    Wave(int size, double coarse_frequency, double fine_frequency, double phase) {
        for (int i = 0; i < size; ++i) {
            x.push_back(in_signed_range(i, size));
            coarse.push_back(std::sin(coarse_frequency * x[i]));
            fine.push_back(std::sin(fine_frequency * x[i] + phase));
        }
    }
};

/// Three wobbling Gaussian shells around the centre, a background of 8 and white noise of ±6.
SampleVoxels make_shells(int size) {
    const Wave a(size, 9, 31, 3), b(size, 8, 29, 1), c(size, 7, 27, 2);
    return generate<std::uint8_t>([=](int i, int j, int k) {
        const double r = std::sqrt(a.x[i] * a.x[i] + b.x[j] * b.x[j] + c.x[k] * c.x[k]);
        const double wobble =
            0.035 * a.coarse[i] * b.coarse[j] * c.coarse[k] + 0.01 * a.fine[i] * b.fine[j] * c.fine[k];
        const auto shell = [&](double height, double radius, double width) {
            const double d = (r + wobble - radius) / width;
            return height * std::exp(-d * d);
        };
        const double value = std::max({8.0, shell(235, 0.28, 0.05), shell(170, 0.55, 0.04), shell(100, 0.82, 0.04)});
        return std::clamp(std::floor(value + (noise(i, j, k) * 12 - 6) + 0.5), 0.0, 255.0);
    });
}

TransferFunction shells_transfer_function() {
    constexpr Rgb blue{0.30, 0.50, 0.95}, green{0.25, 0.75, 0.35}, red{0.90, 0.30, 0.18};
    TransferFunction tf;
    tf.points = {{60, blue, 0},   {88, blue, 0.05}, {106, blue, 0},  {130, green, 0}, {150, green, 0.15},
                 {172, green, 0}, {195, red, 0},    {220, red, 0.8}, {255, red, 0.9}};
    return tf;
}

}  // namespace

Sample marschner_lobb_sample() {
    return {{"marschner-lobb", "the test signal of Marschner and Lobb 1994, float in [0, 1]", 128},
            make_marschner_lobb,
            marschner_lobb_transfer_function};
}

Sample shells_sample() {
    return {
        {"shells", "three nested wobbling shells with white noise, 8 bit", 256}, make_shells, shells_transfer_function};
}

}  // namespace chiaro
