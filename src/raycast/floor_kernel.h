// The floor behind a pixel.
#pragma once
#include "core/srgb.h"
#include "illumination/floor/floor_view.h"
#include "kernel/rgba.h"
#include "raycast/camera_view.h"

namespace chiaro::kernel {

/// Composites a pixel over the floor, which lies behind all that is visible.
struct FloorKernel {
    Rgba* pixels;
    CameraView camera;
    FloorView floor;
    const float* light;  ///< E/π, channel after channel; null: 1 everywhere
    std::int32_t edge;   ///< points a side
    float albedo;
    std::int32_t lens_rays;  ///< through each pixel, of a camera with a lens
    bool linear;             ///< else the light is encoded as the frame's is

    CHIARO_INLINE void operator()(std::int32_t x, std::int32_t y) const {
        Rgba& pixel = pixels[std::int64_t(y) * std::int32_t(camera.width) + x];
        const float open = 1 - pixel.a;
        if (!(open > 0)) return;
        float seen[4] = {0, 0, 0, 0};
        if (camera.lens_mm > 0)
            for (std::int32_t i = 0; i < lens_rays; ++i)
                add(ray_through_lens(camera, float(x), float(y), (float(i) + 0.5f) / float(lens_rays),
                                     0.618034f * float(i) - ::floorf(0.618034f * float(i))),
                    1 / float(lens_rays), seen);
        else
            add(camera.ray(float(x), float(y)), 1, seen);
        if (!(seen[3] > 0)) return;
        const float shown = open * seen[3];
        pixel.r += shown * encoded(seen[0] / seen[3]);
        pixel.g += shown * encoded(seen[1] / seen[3]);
        pixel.b += shown * encoded(seen[2] / seen[3]);
        pixel.a += shown;
    }

private:
    CHIARO_INLINE void add(const Ray<float>& ray, float weight, float (&seen)[4]) const {
        const float t = floor.distance(ray);
        if (t > 1e30f) return;
        const Vec3<float> p = mad(t, ray.direction, ray.origin);
        const float u = floor.u(p), v = floor.v(p), share = weight * floor.share(u, v);
        if (!(share > 0)) return;
        for (int c = 0; c < 3; ++c) seen[c] += share * albedo * light_at(c, u, v);
        seen[3] += share;
    }
    CHIARO_INLINE float light_at(int channel, float u, float v) const {
        if (!light) return 1;
        const auto place = [&](float along) { return (along * (0.5f / FloorView::end) + 0.5f) * float(edge - 1); };
        const float x = place(u), y = place(v);
        const std::int32_t i = min(truncate(x), edge - 2), j = min(truncate(y), edge - 2);
        const float* at = light + (std::int64_t(channel) * edge + j) * edge + i;
        const float s = x - float(i), t = y - float(j);
        return lerp(lerp(at[0], at[1], s), lerp(at[edge], at[edge + 1], s), t);
    }
    CHIARO_INLINE float encoded(float colour) const {
        return linear ? colour : float(srgb_from_linear(double(colour)));
    }
};

}  // namespace chiaro::kernel
