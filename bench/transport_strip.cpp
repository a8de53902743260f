// Pictures by transport and by light's own paths side by side, for the eye.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "rows.h"
#include "transport_metric.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int gap = 4;    ///< pixels between pictures, white
constexpr int block = 4;  ///< differences are those of means over so many pixels per axis

/// Stops that bring all but the brightest hundredth of a frame to 1 at most.
double stops_for(const Frame& frame) {
    std::vector<float> values;
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
        if (i % 4 != 3) values.push_back(frame.rgba[i]);
    const auto most = values.begin() + std::ptrdiff_t(values.size() * 99 / 100);
    std::nth_element(values.begin(), most, values.end());
    return -std::log2(std::max(*most, 1e-6f));
}

/// 4 × how far one is from the other, up or down, block by block: sizes are whole blocks.
Frame difference(const Frame& found, const Frame& ground_truth) {
    constexpr double times = 4;
    Frame off(ground_truth.width, ground_truth.height);
    for (int y = 0; y < off.height; ++y)
        for (int x = 0; x < off.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const auto mean = [&](const Frame& frame) { return block_mean(frame, x / block, y / block, c, block); };
                off.rgba[4 * (std::size_t(y) * off.width + x) + c] =
                    float(times * std::abs(mean(found) - mean(ground_truth)));
            }
    return off;
}

void write_strip(const std::vector<Frame>& frames, const std::filesystem::path& path, double stops) {
    const int each = frames[0].width + gap;
    Frame strip(each * int(frames.size()) - gap, frames[0].height);
    std::fill(strip.rgba.begin(), strip.rgba.end(), float(std::exp2(-stops)));
    for (std::size_t n = 0; n < frames.size(); ++n)
        for (int y = 0; y < strip.height; ++y)
            std::copy_n(&frames[n].rgba[4 * std::size_t(y) * frames[n].width], 4 * frames[n].width,
                        &strip.rgba[4 * (std::size_t(y) * strip.width + n * each)]);
    for (std::size_t i = 3; i < strip.rgba.size(); i += 4) strip.rgba[i] = 1;
    write_png(develop(strip, {.exposure_stops = stops}), path);
}

/// Light scattered once, after 1, 4 and 16 iterations of 64 cells, the ground truth, and 4 × the difference.
Row draw(const Setup& setup, const std::string& name, const std::filesystem::path& path) {
    auto subject = find_scattering_subject(setup.device, setup.data, name, setup.progress);
    if (!subject) return {path.stem().string(), "%", {}, {}, {}, no_data};
    subject->scene.width = subject->scene.height = 144;
    subject->scene.camera.zoom = std::max(subject->scene.camera.zoom, 1.35);
    const TransportErrorMetric::Effort effort{
        .air = 0, .matter = 0, .paths = 1, .paths_a_pixel = setup.quick ? 4 : 512};
    const TransportErrorMetric metric(*subject, {}, effort, setup.progress);
    std::vector<Frame> frames;
    for (const int iterations : {0, 1, 4, 16}) frames.push_back(metric.image(metric.nodes(64, iterations)));
    const double error = 100 * metric.of_image(frames.back(), block).relative;
    frames.push_back(metric.ground_truth());
    frames.push_back(difference(frames[3], metric.ground_truth()));
    write_strip(frames, path, stops_for(metric.ground_truth()));
    return {"transport-strip/" + name, "%", {error, error, error, 1}, {}, {}, path.string()};
}

}  // namespace

/// None but where CHIARO_STRIP_DIR names the folder that they are written to.
std::vector<Case> transport_strip_cases(const Setup& setup) {
    const char* folder = std::getenv("CHIARO_STRIP_DIR");
    if (!folder) return {};
    std::vector<Case> cases;
    for (const std::string& name : scattering_subjects()) {
        const auto path = std::filesystem::path(folder) / fmt::format("transport-{}.png", name);
        cases.push_back({{"transport-strip/" + name}, [=, &setup] { return std::vector{draw(setup, name, path)}; }});
    }
    return cases;
}

}  // namespace chiaro::bench
