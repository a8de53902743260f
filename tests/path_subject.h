// What tests of the path tracer share.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "fixtures.h"
#include "pathtrace/tracer.h"

namespace chiaro::testing {

inline constexpr double pi = std::numbers::pi;

/// Everything a path-traced picture depends on.
struct Subject {
    Device device = tested_device();
    TransferFunction tf = two_materials();
    Shape shape;
    Lighting lighting;
    CameraSettings camera;
    RaySettings rays;
    PathOptions options;
    int width = 13, height = 11;

    std::unique_ptr<PathTracer> traced(const Volume& volume, int samples) const {
        const Camera from = make_camera(camera, volume.geometry, volume.dimensions);
        const Medium medium = classify(upload(device, volume), tf, shape);
        auto tracer = std::make_unique<PathTracer>(device, medium, lighting, from, rays, options, width, height);
        EXPECT_TRUE(tracer->add(samples, Progress()));
        return tracer;
    }
    Frame frame(const Volume& volume, int samples) const {
        Frame f(width, height);
        RenderTarget filled{f};
        traced(volume, samples)->show(filled);
        filled.bring();
        return f;
    }
};

/// A probe whose rows have these radiances, from up to down.
inline Probe rows_of(const std::vector<float>& radiances) {
    std::vector<float> rgb;
    for (float r : radiances) rgb.insert(rgb.end(), {r, r, r});
    return Probe(1, int(radiances.size()), rgb);
}

/// The same from everywhere but for a hair, so that light is drawn and weighed.
inline Probe nearly_white() { return Probe(2, 1, {1, 1, 1, 1.0001f, 1.0001f, 1.0001f}); }

inline Volume small_shells() {
    return sampled<std::uint8_t>({20, 18, 17}, [](double x, double y, double z) { return shells(x, y, z, 19); });
}

}  // namespace chiaro::testing
