#include <chiaro/image.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/srgb.h"
#include "core/threads.h"
#include "image/tone.h"

namespace chiaro {
namespace {

/// Linear light to 8 bit sRGB, rounded exactly: the curve is never steeper than 12.92 * 255 / 4096 < 1 code a cell, so
/// the code at a cell's start is right or one too low.
class SrgbTable {
public:
    SrgbTable() {
        for (int code = 1; code < 256; ++code) lowest_[code] = float(linear_from_srgb((code - 0.5) / 255));
        lowest_[256] = std::numeric_limits<float>::infinity();
        for (int cell = 0; cell <= cells; ++cell) {
            const auto above = std::upper_bound(lowest_.begin() + 1, lowest_.end(), float(cell) / cells);
            code_[cell] = std::uint8_t(above - lowest_.begin() - 1);
        }
    }
    std::uint8_t operator()(float linear) const {
        const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;  // NaN becomes 0
        const int code = code_[int(x * cells)];
        return std::uint8_t(code + (x >= lowest_[code + 1]));
    }

private:
    static constexpr int cells = 4096;
    std::array<float, 257> lowest_{};  ///< smallest linear value that rounds to the code
    std::array<std::uint8_t, cells + 1> code_{};
};

std::uint8_t round_to_byte(float x) { return x > 0 ? std::uint8_t(std::min(x, 1.0f) * 255 + 0.5f) : std::uint8_t(0); }

template <class Encode>
void develop_rows(const Frame& frame, const ToneMap& tone, const std::array<float, 3>& background, const Encode& encode,
                  Image& image) {
    const int channels = image.has_alpha ? 4 : 3;
    const float gain = float(std::exp2(tone.exposure_stops));
    const bool curved = tone.tone == Tone::aces;
    parallel_for(frame.height, 16, [&](std::int64_t first, std::int64_t last) {
        const float* in = frame.rgba.data() + std::size_t(4) * frame.width * first;
        std::uint8_t* out = image.pixels.data() + std::size_t(channels) * frame.width * first;
        for (auto left = (last - first) * frame.width; left > 0; --left, in += 4, out += channels) {
            const float alpha = std::clamp(in[3], 0.0f, 1.0f);
            const auto straight = [&](int c) {  // the premultiplied colour, divided out again
                const float light = alpha > 0 ? gain * in[c] / alpha : 0;
                return curved ? aces(light) : light;
            };
            if (tone.transparent) {
                for (int c = 0; c < 3; ++c) out[c] = encode(straight(c));
                out[3] = round_to_byte(alpha);
            } else {
                for (int c = 0; c < 3; ++c)
                    out[c] = encode((curved ? alpha * straight(c) : gain * in[c]) + (1 - alpha) * background[c]);
            }
        }
    });
}

}  // namespace

Frame expose(Frame frame, const ToneMap& tone) {
    const float gain = float(std::exp2(tone.exposure_stops));
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
        if (i % 4 != 3) frame.rgba[i] *= gain;
    return frame;
}

Image develop(const Frame& frame, const ToneMap& tone) {
    const bool linear = tone.color == ColorMode::linear;
    Image image{frame.width, frame.height, tone.transparent, {}};
    image.pixels.resize(std::size_t(tone.transparent ? 4 : 3) * frame.width * frame.height);
    std::array<float, 3> background{};
    for (int c = 0; c < 3; ++c)
        background[c] = float(linear ? linear_from_srgb(tone.background[c]) : tone.background[c]);
    if (linear) {
        static const SrgbTable table;
        develop_rows(frame, tone, background, table, image);
    } else {
        develop_rows(frame, tone, background, round_to_byte, image);
    }
    return image;
}

}  // namespace chiaro
