#include "overlay.h"

#include <fmt/format.h>

#include <array>

#include "core/srgb.h"
#include "image/png.h"

namespace chiaro::server {
namespace {

constexpr std::size_t max_overlays = 4;

/// RFC 4648, without line breaks.
std::vector<std::byte> decode_base64(std::string_view text) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    while (text.ends_with('=')) text.remove_suffix(1);
    std::vector<std::byte> bytes;
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        const std::size_t digit = alphabet.find(c);
        if (digit == alphabet.npos) throw Error(ErrorCode::usage, "overlays: png must be base64 text");
        bits = bits << 6 | std::uint32_t(digit), held += 6;
        if (held < 8) continue;
        held -= 8;
        bytes.push_back(std::byte(bits >> held & 255));
    }
    return bytes;
}

/// Four bytes of a PNG's header: its width stands at 16, its height at 20.
std::int64_t number_at(const std::vector<std::byte>& bytes, std::size_t at) {
    if (bytes.size() < at + 4) throw Error(ErrorCode::usage, "overlays: png holds no PNG file");
    std::int64_t number = 0;
    for (std::size_t i = at; i < at + 4; ++i) number = number << 8 | std::int64_t(bytes[i]);
    return number;
}

Overlay overlay_of(const Json& json, int width, int height) {
    const auto at = json.is_object() ? json.find("at") : json.end();
    if (!json.is_object() || at == json.end() || !at->is_array() || at->size() != 2 || !(*at)[0].is_number_integer() ||
        !(*at)[1].is_number_integer())
        throw Error(ErrorCode::usage, "overlays: each must have \"at\": [x, y] and \"png\"");
    const std::vector<std::byte> bytes = decode_base64(text_in(json, "png"));
    // Before pixels are made room for: a small file may hold many.
    const std::int64_t wide = number_at(bytes, 16), high = number_at(bytes, 20);
    const std::int64_t x = (*at)[0].get<std::int64_t>(), y = (*at)[1].get<std::int64_t>();
    if (x < 0 || y < 0 || x > width - wide || y > height - high)
        throw Error(ErrorCode::usage, fmt::format("overlays: {} x {} at {}, {} does not lie within {} x {}", wide, high,
                                                  x, y, width, height));
    Image image;
    try {
        image = decode_png(bytes, "overlays").image;
    } catch (const Error& error) {
        throw Error(ErrorCode::usage, error.what());
    }
    return {int(x), int(y), std::move(image)};
}

/// Calls put(index of the pixel below, its 3 bytes of colour, alpha in 0..1) for all that is not clear.
template <class Put>
void for_pixels(const Overlay& overlay, int width, const Put& put) {
    const Image& image = overlay.image;
    const std::size_t parts = image.has_alpha ? 4 : 3;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t* pixel = &image.pixels[parts * (std::size_t(y) * image.width + x)];
            const double alpha = image.has_alpha ? pixel[3] / 255.0 : 1;
            if (alpha > 0) put(std::size_t(overlay.y + y) * width + overlay.x + x, pixel, alpha);
        }
}

}  // namespace

std::vector<Overlay> overlays_in(const Json& request, int width, int height) {
    std::vector<Overlay> overlays;
    const auto list = request.find("overlays");
    if (list == request.end()) return overlays;
    if (!list->is_array() || list->size() > max_overlays)
        throw Error(ErrorCode::usage, fmt::format("overlays: must be a list of at most {}", max_overlays));
    for (const Json& json : *list) overlays.push_back(overlay_of(json, width, height));
    return overlays;
}

void draw(const Overlay& overlay, Image& image) {
    const std::size_t parts = image.has_alpha ? 4 : 3;
    for_pixels(overlay, image.width, [&](std::size_t at, const std::uint8_t* colour, double alpha) {
        std::uint8_t* below = &image.pixels[parts * at];
        const double under = (image.has_alpha ? below[3] / 255.0 : 1) * (1 - alpha), whole = alpha + under;
        for (int c = 0; c < 3; ++c) below[c] = std::uint8_t((alpha * colour[c] + under * below[c]) / whole + 0.5);
        if (image.has_alpha) below[3] = std::uint8_t(255 * whole + 0.5);
    });
}

void draw(const Overlay& overlay, Frame& frame) {
    for_pixels(overlay, frame.width, [&](std::size_t at, const std::uint8_t* colour, double alpha) {
        float* below = &frame.rgba[4 * at];
        for (int c = 0; c < 3; ++c)
            below[c] = float(alpha * linear_from_srgb(colour[c] / 255.0) + (1 - alpha) * below[c]);
        below[3] = float(alpha + (1 - alpha) * below[3]);
    });
}

}  // namespace chiaro::server
