// Small volumes, transfer functions and pictures that several tests share.
#pragma once
#include <chiaro/chiaro.h>

#include <cmath>
#include <functional>

#include "devices.h"

namespace chiaro::testing {

using Field = std::function<double(double x, double y, double z)>;

/// f at the voxel centres (voxel coordinates).
template <class T>
Volume sampled(std::array<int, 3> n, const Field& f) {
    Volume volume = make_volume(n, voxel_type_of<T>());
    auto voxels = volume.as<T>();
    std::size_t i = 0;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x)
                voxels[i++] = T(std::is_integral_v<T> ? std::lround(f(x, y, z)) : f(x, y, z));
    return volume;
}

/// Nested soft shells on a 0..255 scale: matter at several depths, empty space between.
inline double shells(double x, double y, double z, double size) {
    const double c = (size - 1) / 2, r = std::sqrt((x - c) * (x - c) + (y - c) * (y - c) + (z - c) * (z - c)) / c;
    return 120 * std::exp(-std::pow((r - 0.8) / 0.08, 2)) + 220 * std::exp(-std::pow((r - 0.35) / 0.1, 2));
}

/// The same opacity for every value.
inline TransferFunction constant(double opacity, Rgb rgb = {1, 1, 1}) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    tf.points = {{0, rgb, opacity}, {255, rgb, opacity}};
    return tf;
}

/// Two translucent materials on a 0..255 scale, nothing below 60.
inline TransferFunction two_materials() {
    TransferFunction tf;
    tf.points = {{60, {0.2, 0.4, 0.9}, 0},
                 {110, {0.2, 0.4, 0.9}, 0.15},
                 {150, {0.3, 0.8, 0.3}, 0},
                 {170, {0.9, 0.4, 0.1}, 0},
                 {220, {0.9, 0.4, 0.1}, 0.7}};
    return tf;
}

/// Everything a ray-cast picture depends on, with plain defaults: no shading, no termination.
struct Shot {
    Device device = tested_device();
    TransferFunction tf = two_materials();
    Shape shape;
    Lighting lighting{.shading = Shading::none};
    CameraSettings camera;
    RaySettings rays{.step_voxels = 0.5, .early_termination = 0, .skip_empty = true};
    int width = 61, height = 47;  // not multiples of the block or the tile

    Frame operator()(const DeviceVolume& volume) const {
        Frame frame(width, height);
        Progress progress;
        raycast(device, classify(volume, tf, shape), IlluminationField(), lighting,
                make_camera(camera, volume.geometry(), volume.dimensions()), rays, frame, progress);
        return frame;
    }
    Frame operator()(const Volume& volume) const { return (*this)(upload(device, volume)); }

    /// With the light found first.
    Frame lit(const Volume& volume, const IlluminationSettings& settings) const {
        Frame frame(width, height);
        Progress progress;
        const Medium medium = classify(upload(device, volume), tf, shape);
        IlluminationField field;
        const auto keep = [&](IlluminationField finer) { field = std::move(finer); };
        illuminate(device, medium, Prepared(), lighting, settings, keep, progress);
        raycast(device, medium, field, lighting, make_camera(camera, volume.geometry, volume.dimensions), rays, frame,
                progress);
        return frame;
    }
};

inline constexpr CameraSettings along_x{.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};

/// The camera of one ray along y, through (x, ·, z).
inline Camera along_y(double x, double z) {
    return {.eye = {x, -1000, z},
            .forward = {0, 1, 0},
            .right = {1, 0, 0},
            .up = {0, 0, 1},
            .projection = Projection::orthographic,
            .half_height = 0.1};
}

/// Constant extinction, 32 mm of it along the rays.
struct ConstantExtinction {
    Volume volume = sampled<std::uint8_t>({65, 33, 33}, [](double, double, double) { return 100; });
    Shot shot;
    double per_mm = -std::log1p(-0.1);
    double entry_mm;  ///< from the eye

    ConstantExtinction() {
        volume.geometry.spacing_mm = {0.5, 1, 1.25};
        shot.camera = along_x;
        shot.tf = constant(0.1);
        shot.tf.opacity_unit_is_mm = true;
        const Camera camera = make_camera(along_x, volume.geometry, volume.dimensions);
        entry_mm = dot(volume.geometry.world_from_voxel({64, 16, 16}) - camera.eye, camera.forward);
    }
};

/// Largest absolute difference, and how many pixels differ by more than `tolerance`.
struct Difference {
    double max = 0;
    int pixels_beyond = 0;
};
inline Difference difference(const Frame& a, const Frame& b, double tolerance) {
    Difference d;
    for (std::size_t p = 0; p < a.rgba.size(); p += 4) {
        double worst = 0;
        for (int c = 0; c < 4; ++c) worst = std::fmax(worst, std::abs(double(a.rgba[p + c]) - b.rgba[p + c]));
        d.max = std::fmax(d.max, worst);
        d.pixels_beyond += worst > tolerance;
    }
    return d;
}

inline double mean_alpha(const Frame& frame) {
    double sum = 0;
    for (std::size_t p = 3; p < frame.rgba.size(); p += 4) sum += frame.rgba[p];
    return sum / (frame.rgba.size() / 4.0);
}

}  // namespace chiaro::testing
