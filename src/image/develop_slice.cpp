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

Image develop(const std::vector<SliceChannel>& channels) {
    if (channels.empty()) throw Error(ErrorCode::usage, "slice: there is no channel");
    const Slice& first = channels.front().slice;
    for (const SliceChannel& channel : channels) {
        if (!(channel.high > channel.low)) throw Error(ErrorCode::usage, "window: must be wider than 0");
        if (channel.slice.width != first.width || channel.slice.height != first.height)
            throw Error(ErrorCode::usage, "slice: channels are of one size");
    }
    Image image{first.width, first.height, false, std::vector<std::uint8_t>(3 * first.values.size())};
    parallel_for(std::int64_t(first.values.size()), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = begin; i < end; ++i) {
            Rgb sum{};
            for (const SliceChannel& channel : channels) {
                const double value = channel.slice.values[std::size_t(i)];
                if (std::isnan(value)) continue;
                const double share = std::clamp((value - channel.low) / (channel.high - channel.low), 0.0, 1.0);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += share * channel.color[c];
            }
            for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * std::size_t(i) + c] = byte_of(sum[c]);
        }
    });
    return image;
}

void lay_over(Image& image, const std::vector<std::uint16_t>& numbers, const std::vector<Label>& looks,
              double opacity) {
    if (numbers.size() != std::size_t(image.width) * image.height || image.has_alpha)
        throw Error(ErrorCode::usage, "slice: the labels' is of another size");
    const auto is_border = [&](std::int64_t i) {
        const auto n = numbers[std::size_t(i)];
        const std::int64_t x = i % image.width, y = i / image.width, w = image.width;
        return (x > 0 && numbers[std::size_t(i - 1)] != n) || (x + 1 < w && numbers[std::size_t(i + 1)] != n) ||
               (y > 0 && numbers[std::size_t(i - w)] != n) ||
               (y + 1 < image.height && numbers[std::size_t(i + w)] != n);
    };
    parallel_for(std::int64_t(numbers.size()), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = begin; i < end; ++i) {
            const Label& label = looks[numbers[std::size_t(i)]];
            if (!label.show || label.tint == 0) continue;
            const double cover = label.tint * (is_border(i) ? 1 : opacity);
            for (std::size_t c = 0; c < 3; ++c) {
                std::uint8_t& byte = image.pixels[3 * std::size_t(i) + c];
                byte = byte_of(byte / 255.0 + cover * (label.rgb[c] - byte / 255.0));
            }
        }
    });
}

}  // namespace chiaro
