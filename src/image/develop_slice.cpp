#include <chiaro/error.h>
#include <chiaro/image.h>

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "core/threads.h"

namespace chiaro {
namespace {

std::uint8_t byte_of(double share) { return std::uint8_t(std::floor(std::clamp(share, 0.0, 1.0) * 255 + 0.5)); }

double largest_opacity(const TransferFunction& tf) {
    double most = 0;
    for (const ControlPoint& point : tf.points) most = std::max(most, point.opacity);
    return most;
}

}  // namespace

Image develop(const Slice& slice, const SliceTone& tone) {
    if (!(tone.high > tone.low)) throw Error(ErrorCode::usage, "window: must be wider than 0");
    if (tone.colors) validate(*tone.colors);
    const double most = tone.colors ? largest_opacity(*tone.colors) : 0;
    Image image{slice.width, slice.height, false, std::vector<std::uint8_t>(3 * slice.values.size())};
    parallel_for(std::int64_t(slice.values.size()), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = begin; i < end; ++i) {
            const double value = slice.values[std::size_t(i)];
            if (std::isnan(value)) continue;
            const double grey = std::clamp((value - tone.low) / (tone.high - tone.low), 0.0, 1.0);
            Rgb rgb{grey, grey, grey};
            if (most > 0 && value >= tone.shown_low && value <= tone.shown_high) {
                const ControlPoint seen = evaluate(*tone.colors, value);
                const double cover = seen.opacity / most;
                for (std::size_t c = 0; c < 3; ++c) {
                    const bool is_linear = tone.colors->rgb_space == RgbSpace::linear;
                    rgb[c] += cover * ((is_linear ? srgb_from_linear(seen.rgb[c]) : seen.rgb[c]) - rgb[c]);
                }
            }
            for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * std::size_t(i) + c] = byte_of(rgb[c]);
        }
    });
    return image;
}

}  // namespace chiaro
