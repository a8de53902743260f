// The light probe behind a pixel.
#pragma once
#include "core/srgb.h"
#include "kernel/rgba.h"

namespace chiaro::kernel {

/// atan2 in turns, [-½, ½], within 1e-7: the polynomial 4.4.49 of Abramowitz and Stegun. Every pixel needs two.
CHIARO_INLINE float turns(float y, float x) {
    const float across = ::fabsf(y), along = ::fabsf(x), more = max(across, along);
    const float t = min(across, along) / max(more, 1e-30f), q = t * t, qq = q * q;
    // In pairs of terms, which a CPU finds side by side.
    const float ends = (0.0429096138f - 0.0161657367f * q) + 0.0028662257f * qq;
    const float middle = (0.1065626393f - 0.0752896400f * q) + ends * qq;
    const float series = (1 - 0.3333314528f * q) + ((0.1999355085f - 0.1420889944f * q) + middle * qq) * qq;
    float angle = t * series * float(0.5 / 3.14159265358979323846);
    angle = across > along ? 0.25f - angle : angle;
    angle = x < 0 ? 0.5f - angle : angle;
    return y < 0 ? -angle : angle;
}

/// A picture of radiance (ProbeImage).
struct ImageView {
    const float* rgb;
    std::int32_t width, height;

    /// Between pixel centres bilinear, around the azimuth without an end; up and down the outermost rows go on.
    CHIARO_INLINE Vec3<float> towards(Vec3<double> d) const {
        const float dx = float(d.x), dy = float(d.y), dz = float(d.z);
        const float x = (0.5f - turns(dy, dx)) * float(width);  // as ProbeImage::place
        const float y = 2 * turns(sqrt(dx * dx + dy * dy), dz) * float(height);
        const std::int32_t left = truncate(x + 0.5f) - 1, above = truncate(y + 0.5f) - 1;
        const float along = x - 0.5f - float(left), down = y - 0.5f - float(above);
        const float *a = pixel(left, above), *b = pixel(left + 1, above);
        const float *c = pixel(left, above + 1), *e = pixel(left + 1, above + 1);
        return {mix(a[0], b[0], c[0], e[0], along, down), mix(a[1], b[1], c[1], e[1], along, down),
                mix(a[2], b[2], c[2], e[2], along, down)};
    }

private:
    CHIARO_INLINE const float* pixel(std::int32_t column, std::int32_t row) const {
        column = column < 0 ? column + width : column < width ? column : column - width;
        return rgb + 3 * (std::size_t(min(max(row, 0), height - 1)) * width + column);
    }
    static CHIARO_INLINE float mix(float a, float b, float c, float d, float along, float down) {
        return lerp(lerp(a, b, along), lerp(c, d, along), down);
    }
};

/// Composites a pixel over the probe, which is infinitely far off; its alpha becomes 1.
struct BackgroundKernel {
    Rgba* pixels;
    std::int32_t width;
    ImageView image;
    Vec3<double> first, right, down;  ///< in the probe's frame, towards pixel (0, 0) and from one to the next
    float gain;
    bool linear;  ///< else the light is encoded as the frame's is

    CHIARO_INLINE void operator()(std::int32_t x, std::int32_t y) const {
        Rgba& pixel = pixels[std::int64_t(y) * width + x];
        const float open = 1 - pixel.a;
        pixel.a = 1;
        if (!(open > 0)) return;
        const Vec3<float> light = image.towards(first + double(x) * right + double(y) * down);
        pixel.r += open * shown(light.x);
        pixel.g += open * shown(light.y);
        pixel.b += open * shown(light.z);
    }

private:
    CHIARO_INLINE float shown(float light) const {
        return linear ? gain * light : float(srgb_from_linear(double(gain * light)));
    }
};

}  // namespace chiaro::kernel
