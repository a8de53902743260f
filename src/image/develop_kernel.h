// From a pixel of light to its 8 bits.
#pragma once
#include "image/tone.h"
#include "kernel/rgba.h"

namespace chiaro::kernel {

/// Linear light to 8 bit sRGB, rounded exactly: the curve is never steeper than 12.92 * 255 / 4096 < 1 code a cell, so
/// the code at a cell's start is right or one too low.
struct SrgbCode {
    static constexpr int cells = 4096;
    const float* lowest;       ///< smallest linear value that rounds to each code; behind the last infinity
    const std::uint8_t* code;  ///< at each cell's start, and at the end

    CHIARO_INLINE std::uint8_t operator()(float linear) const {
        const float x = linear > 0 ? min(linear, 1.0f) : 0.0f;  // NaN becomes 0
        const int below = code[int(x * cells)];
        return std::uint8_t(below + (x >= lowest[below + 1]));
    }
};

struct RoundToByte {
    CHIARO_INLINE std::uint8_t operator()(float x) const {
        return x > 0 ? std::uint8_t(min(x, 1.0f) * 255 + 0.5f) : std::uint8_t(0);
    }
};

/// develop() of one pixel.
template <class Encode>
struct DevelopKernel {
    const Rgba* in;
    std::uint8_t* out;  ///< 4 a pixel where it is transparent, else 3
    Encode encode;
    Float3 background;
    float gain;
    bool curved, transparent;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const Rgba light = in[i];
        const float alpha = std::clamp(light.a, 0.0f, 1.0f);
        if (transparent) {
            std::uint8_t* to = out + 4 * i;
            to[0] = encode(straight(light.r, alpha));
            to[1] = encode(straight(light.g, alpha));
            to[2] = encode(straight(light.b, alpha));
            to[3] = RoundToByte()(alpha);
        } else {
            std::uint8_t* to = out + 3 * i;
            to[0] = encode(over(light.r, alpha, background.x));
            to[1] = encode(over(light.g, alpha, background.y));
            to[2] = encode(over(light.b, alpha, background.z));
        }
    }

private:
    /// The premultiplied colour, divided out again.
    CHIARO_INLINE float straight(float light, float alpha) const {
        const float divided = alpha > 0 ? gain * light / alpha : 0;
        return curved ? aces(divided) : divided;
    }
    CHIARO_INLINE float over(float light, float alpha, float behind) const {
        return (curved ? alpha * straight(light, alpha) : gain * light) + (1 - alpha) * behind;
    }
};

}  // namespace chiaro::kernel
