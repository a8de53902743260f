#include <chiaro/image.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/srgb.h"
#include "core/threads.h"
#include "image/gpu.h"

namespace chiaro {
namespace {

/// What SrgbCode reads.
struct SrgbTable {
    static constexpr int cells = kernel::SrgbCode::cells;
    std::array<float, 257> lowest{};
    std::array<std::uint8_t, cells + 1> code{};

    SrgbTable() {
        for (int c = 1; c < 256; ++c) lowest[c] = float(linear_from_srgb((c - 0.5) / 255));
        lowest[256] = std::numeric_limits<float>::infinity();
        for (int cell = 0; cell <= cells; ++cell) {
            const auto above = std::upper_bound(lowest.begin() + 1, lowest.end(), float(cell) / cells);
            code[cell] = std::uint8_t(above - lowest.begin() - 1);
        }
    }
};

/// One for all frames, so that a GPU needs it once.
const std::shared_ptr<const SrgbTable>& srgb_table() {
    static const auto table = std::make_shared<const SrgbTable>();
    return table;
}

template <class Encode>
kernel::DevelopKernel<Encode> kernel_of(const ToneMap& tone, const Encode& encode) {
    const bool linear = tone.color == ColorMode::linear;
    const auto shown = [&](int c) { return float(linear ? linear_from_srgb(tone.background[c]) : tone.background[c]); };
    return {.in = nullptr,
            .out = nullptr,
            .encode = encode,
            .background = {shown(0), shown(1), shown(2)},
            .gain = float(std::exp2(tone.exposure_stops)),
            .curved = tone.tone == Tone::aces,
            .transparent = tone.transparent};
}

/// run(kernel): its encoding is that of the tone's colours.
template <class Run>
void with_kernel(const ToneMap& tone, const Run& run) {
    if (tone.color == ColorMode::linear)
        run(kernel_of(tone, kernel::SrgbCode{srgb_table()->lowest.data(), srgb_table()->code.data()}));
    else
        run(kernel_of(tone, kernel::RoundToByte{}));
}

Image undeveloped(int width, int height, const ToneMap& tone) {
    const std::size_t channels = tone.transparent ? 4 : 3;
    return {width, height, tone.transparent, std::vector<std::uint8_t>(channels * width * height)};
}

}  // namespace

Frame expose(const Frame& frame, const ToneMap& tone, const Progress* progress) {
    const float gain = float(std::exp2(tone.exposure_stops));
    Frame exposed(frame.width, frame.height);
    const std::int64_t row = 4 * std::int64_t(frame.width);
    parallel_for(frame.height, 16, [&](std::int64_t first, std::int64_t last) {
        if (progress && progress->cancelled()) return;
        for (std::int64_t i = first * row; i < last * row; ++i)
            exposed.rgba[i] = i % 4 != 3 ? frame.rgba[i] * gain : frame.rgba[i];
    });
    if (progress) progress->check();
    return exposed;
}

Image develop(const Frame& frame, const ToneMap& tone) {
    Image image = undeveloped(frame.width, frame.height, tone);
    with_kernel(tone, [&](auto kernel) {
        kernel.in = reinterpret_cast<const kernel::Rgba*>(frame.rgba.data());
        kernel.out = image.pixels.data();
        const std::int64_t row = frame.width;
        parallel_for(frame.height, 16, [&](std::int64_t first, std::int64_t last) {
            for (std::int64_t i = first * row; i < last * row; ++i) kernel(i);
        });
    });
    return image;
}

Image develop(const DeviceFrame& frame, const ToneMap& tone) {
    if (!frame.on_gpu()) return develop(frame.read(), tone);
    const cuda::Pixels& pixels = *frame.on_gpu();
    Image image = undeveloped(frame.width(), frame.height(), tone);
    HostArrays arrays;
    arrays.add(srgb_table(), srgb_table()->lowest);
    arrays.add(srgb_table(), srgb_table()->code);
    const bool done = cuda::try_gpu(pixels.stream(), [&] {
        with_kernel(tone, [&](const auto& kernel) { develop_on_gpu(pixels, kernel, arrays, image.pixels); });
    });
    return done ? image : develop(frame.read(), tone);
}

}  // namespace chiaro
