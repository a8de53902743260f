#include <chiaro/error.h>
#include <fmt/format.h>

#include "illumination/probe/data.h"

namespace chiaro {
namespace {

constexpr int longest_side = 65536;

/// Radiance that light can have; what is no number counts as none.
float sane(float radiance) {
    constexpr float largest_half = 65504;
    if (std::isinf(radiance) && radiance > 0) return largest_half;
    return radiance > 0 ? radiance : 0;
}

}  // namespace

Probe::Probe(int width, int height, std::vector<float> rgb) {
    if (width < 1 || height < 1 || width > longest_side || height > longest_side)
        throw Error(ErrorCode::input, fmt::format("a light probe of {} x {} pixels: must be 1 to {} a side", width,
                                                  height, longest_side));
    if (rgb.size() != std::size_t(3) * width * height)
        throw Error(ErrorCode::input,
                    fmt::format("a light probe of {} x {} pixels with {} values: must have three a pixel", width,
                                height, rgb.size()));
    for (float& radiance : rgb) radiance = sane(radiance);
    data_ = std::make_shared<const Data>(ProbeImage{width, height, std::move(rgb)});
}

int Probe::width() const { return data_ ? data_->image.width : 0; }
int Probe::height() const { return data_ ? data_->image.height : 0; }
std::span<const float> Probe::rgb() const {
    return data_ ? std::span<const float>(data_->image.rgb) : std::span<const float>();
}

}  // namespace chiaro
