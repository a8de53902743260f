// What tests of light at surfaces in the volume share: volumes with soft edges, and how they are looked at.
#pragma once
#include <algorithm>
#include <random>

#include "path_subject.h"

namespace chiaro::testing {

inline constexpr int n = 64;
inline constexpr Vec3 centre{31.7, 31.9, 31.4};
inline constexpr double grey = 0.8;

/// Opacity 0 to .95 of a voxel within a range of values, of one grey.
inline TransferFunction skin(double from = 60, double to = 140) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    tf.points = {{from, {grey, grey, grey}, 0}, {to, {grey, grey, grey}, 0.95}};
    return tf;
}

/// Values that fall from `inside` to 0 where the distance to a surface goes from negative to positive.
inline double logistic(double distance, double edge, double inside = 200) {
    return inside / (1 + std::exp(std::clamp(distance / edge, -60.0, 60.0)));
}

template <class Values>
Volume volume_of(const Values& values, double noise = 0) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    return sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) {
        return std::clamp(std::round(values(Vec3{x, y, z}) + (noise > 0 ? noise * normal(random) : 0)), 0.0, 255.0);
    });
}

/// What an eye sees that looks along -normal, with parallel rays from a square about `above` on.
struct Look {
    Vec3 above, normal, along;  ///< `along`: to the right in the picture
    double half_width;
    int pixels = 24;
};

inline Camera camera_of(const Look& look) {
    return {.eye = look.above,
            .forward = -1.0 * look.normal,
            .right = look.along,
            .up = cross(look.normal, look.along),
            .projection = Projection::orthographic,
            .half_height = look.half_width};
}

inline const Lighting matte{.specular = 0};

inline Frame seen(const Volume& volume, const Look& look, const PathOptions& options, int paths,
                  const TransferFunction& tf = skin(), const Lighting& lighting = matte, const Shape& shape = {}) {
    const Device device = tested_device();
    PathTracer tracer(device, classify(upload(device, volume), tf, shape), lighting, camera_of(look), {}, options,
                      look.pixels, look.pixels);
    EXPECT_TRUE(tracer.add(paths, Progress()));
    Frame frame(look.pixels, look.pixels);
    RenderTarget target{frame};
    tracer.show(target);
    target.bring();
    return frame;
}

/// What an eye sees of a volume that a live method lights.
inline Frame shown(const Volume& volume, const Look& look, const IlluminationSettings& settings,
                   const TransferFunction& tf = skin(), const Lighting& lighting = matte, const Shape& shape = {},
                   const RaySettings& rays = {}) {
    const Device device = tested_device();
    const Medium medium = classify(upload(device, volume), tf, shape);
    IlluminationField field;
    Progress progress;
    illuminate(
        device, medium, Prepared(), lighting, settings, [&](IlluminationField finer) { field = std::move(finer); },
        progress);
    Frame frame(look.pixels, look.pixels);
    raycast(device, medium, field, lighting, camera_of(look), rays, frame, progress);
    return frame;
}

/// The share of irradiance, by column of the picture: light over the grey.
inline std::vector<double> irradiance_of_columns(const Frame& frame) {
    std::vector<double> columns(std::size_t(frame.width), 0);
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x)
            columns[std::size_t(x)] += frame.rgba[4 * (std::size_t(y) * frame.width + x) + 1] / grey / frame.height;
    return columns;
}
inline double mean(const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x;
    return sum / double(v.size());
}

/// What the frame shows of a grey of 1, where it covers.
inline double brightness(const Frame& frame) { return mean(irradiance_of_columns(frame)); }

/// Seen with white light that is scattered once, what arrives; of columns that are alike in the picture, one mean.
inline double irradiance(const Volume& volume, const Look& look, const TransferFunction& tf = skin()) {
    return mean(irradiance_of_columns(seen(volume, look, {.bounces = 0, .surfaces = true}, 64, tf)));
}

inline Volume ball(double edge, double radius, Vec3 spacing = {1, 1, 1}, double noise = 0) {
    Volume volume = volume_of(
        [&](Vec3 p) {
            return logistic(length(Vec3{p.x * spacing.x, p.y * spacing.y, p.z * spacing.z} - centre) - radius, edge);
        },
        noise);
    volume.geometry.spacing_mm = spacing;
    return volume;
}
inline Look at_ball(double radius, Vec3 normal = {0.6, 0, 0.8}) {
    return {centre + (radius + 5) * normal, normal, {0, 1, 0}, radius / 2};
}

}  // namespace chiaro::testing
