// What slopes send back of a sun's light by transport, whose cells are their steps, against the closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "classify/medium.h"
#include "fixtures.h"
#include "illumination/probe/data.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/opaque.h"
#include "illumination/transport/transport.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int edge = 48;
constexpr double middle = (edge - 1) / 2.0, low = 2.5, high = 4.5;  ///< voxels above the slope: where light is read
Vec3 from_middle(double x, double y, double z) { return {x - middle, y - middle, z - middle}; }

struct Sun {
    Lighting lighting;
    Vec3 direction;
};
/// One bright pixel in the dark, nearest to a direction.
Sun sun_from(Vec3 direction) {
    constexpr int width = 360, height = 180;
    const ProbeImage at{width, height, {}};
    const auto of = [&](int i) { return at.direction(i % width + 0.5, i / width + 0.5); };
    int best = 0;
    for (int i = 1; i < width * height; ++i)
        if (dot(of(i), direction) > dot(of(best), direction)) best = i;
    std::vector<float> rgb(std::size_t(3) * width * height);
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * std::size_t(best) + c] = 4000;
    Sun sun{{}, of(best)};
    sun.lighting.loaded_probe = Probe(width, height, std::move(rgb));
    sun.lighting.probe.exposure = 0;
    return sun;
}

/// J above a slope of particles of that albedo: the mean of nodes about its middle.
double light_above(Vec3 normal, double albedo, const Lighting& lighting) {
    const Volume volume = sampled<std::uint8_t>({edge, edge, edge}, [&](double x, double y, double z) {
        return dot(normal, from_middle(x, y, z)) < 0 ? 200 : 0;
    });
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    const Rgb rgb{albedo, albedo, albedo};
    tf.points = {{100, rgb, 0}, {101, rgb, 1}};
    const Device device = tested_device();
    Progress progress;
    TransportSolver solver(device, classify(upload(device, volume), tf, {}).data(), lighting,
                           {.grid = 128, .error = 1e-7}, {.albedo_max = 1}, {0, 0, 1}, progress);
    for (int i = 0; i < 6 && solver.iterate(progress); ++i) {
    }
    const TransportNodes nodes = solver.nodes();
    double sum = 0, count = 0;
    for (int z = edge / 3; z < 2 * edge / 3; ++z)
        for (int y = edge / 3; y < 2 * edge / 3; ++y)
            for (int x = edge / 3; x < 2 * edge / 3; ++x) {
                const double above = dot(normal, from_middle(x, y, z));
                if (above > low && above < high) sum += nodes.light[3 * nodes.grid.index(x, y, z)], count += 1;
            }
    return sum / count;
}

/// Share of all directions that meet the slope within the volume from there.
double seen_of_slope(Vec3 normal) {
    const auto directions = fibonacci_directions(4000);
    double seen = 0;
    for (const Vec3 d : directions) {
        const double along = dot(normal, d), above = (low + high) / 2;
        if (along >= 0) continue;
        const Vec3 p = above * normal - (above / along) * d;
        seen += std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < edge / 2.0;
    }
    return seen / double(directions.size());
}

}  // namespace

/// R E / π over what is seen of it, E by the cosine. Steps that answered for their own faces alone would send back .5
/// for .71 on a slope of 45 degrees, and of a low sun what their neighbours leave of it.
TEST(SunlitSlopes, ReflectByTheirCosine) {
    constexpr double albedo = 0.8;
    for (const Vec3 slope : {Vec3{0, 0, 1}, {1, 0, 1}, {1, 0, 2}, {1, 1, 1}, {1, -2, 3}})
        for (const Vec3 off : {Vec3{0, 0, 0}, {1.2, 1, 0.3}}) {
            const Vec3 normal = normalized(slope);
            const auto [lighting, sun] = sun_from(normalized(normal + off));
            const double direct = light_above(normal, 0, lighting),
                         scattered = light_above(normal, albedo, lighting) - direct,
                         truth = half_space_reflectance(albedo) * 4 * direct * dot(normal, sun) * seen_of_slope(normal);
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("slope {} {} {}, cosine {:.2f}: {:.3f}\n", slope.x, slope.y, slope.z, dot(normal, sun),
                           scattered / truth);
            EXPECT_NEAR(scattered / truth, 1, 0.18) << slope.x << slope.y << slope.z << " " << dot(normal, sun);
        }
}
