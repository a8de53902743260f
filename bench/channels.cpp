// What several channels cost: the same matter as n channels of an nth each, against one.
#include <fmt/format.h>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int counts[] = {2, 4, 8};

TransferFunction hull() {
    TransferFunction tf;
    tf.points = {{60, {0.9, 0.5, 0.2}, 0}, {240, {0.3, 0.6, 0.9}, 0.2}};
    return tf;
}

/// Shaded frames of the ray caster alone, all samples taken alike.
class ChannelFrames {
public:
    explicit ChannelFrames(const Setup& setup)
        : device_(setup.device),
          progress_(setup.progress),
          volume_(upload(device_, make_sample("shells", setup.quick ? 64 : 256))),
          camera_(make_camera(CameraSettings(), volume_.geometry(), volume_.dimensions())),
          frame_(setup.quick ? 128 : 512, setup.quick ? 96 : 384) {}

    double milliseconds(int channels) {
        const Medium medium = classify(
            device_, std::vector<Channel>(std::size_t(channels), {volume_, hull(), 1.0 / channels}), {}, progress_);
        const double seconds = cpu_seconds(
            [&] { raycast(device_, medium, {}, {}, camera_, {.early_termination = 0}, frame_, progress_); });
        progress_.check();
        return 1e3 * seconds;
    }

private:
    const Device device_;
    Progress& progress_;
    const DeviceVolume volume_;
    const Camera camera_;
    Frame frame_;
};

std::string name_of(int channels) { return fmt::format("channels/{}", channels); }

}  // namespace

std::vector<Case> channel_cases(const Setup& setup) {
    std::vector<std::string> names;
    for (const int n : counts) names.push_back(name_of(n));
    const auto rows = [&setup] {
        ChannelFrames frames(setup);
        std::vector<Measure> measures{[&] { return frames.milliseconds(1); }};
        for (const int n : counts) measures.push_back([&frames, n] { return frames.milliseconds(n); });
        const std::vector<Series> series = in_turns(setup.runs, measures);
        std::vector<Row> found;
        for (std::size_t i = 1; i < series.size(); ++i)
            found.push_back({name_of(counts[i - 1]), "ms/frame", spread_of(series[i]),
                             median_ratio(series[i], series[0]), "one channel",
                             fmt::format("at most {:.1f}", 0.5 + 0.7 * counts[i - 1])});
        return found;
    };
    return {{names, rows}};
}

}  // namespace chiaro::bench
