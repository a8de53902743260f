// What empty-space skipping saves, and that it changes nothing else.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "turntable.h"

namespace chiaro::bench {
namespace {

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(double(a[i]) - double(b[i])));
    return largest;
}

Row measure(const Setup& setup, const std::string& scene, const std::string& name) {
    Turntable turntable(setup, scene);
    if (!turntable.has_data()) return {name, "ms/frame", {}, {}, {}, no_data};
    turntable.scene().lighting.shading = Shading::none;
    std::vector<float> pictures[2];
    const auto with = [&](bool skip) {
        return [&, skip] {
            turntable.scene().sampling.skip_empty = skip;
            const double milliseconds = 1e3 * turntable.seconds_per_frame();
            pictures[skip] = turntable.frame().rgba;
            return milliseconds;
        };
    };
    const auto series = in_turns(setup.runs, {with(false), with(true)});
    const double difference = largest_difference(pictures[0], pictures[1]);
    return {name,
            "ms/frame",
            spread_of(series[1]),
            median_ratio(series[0], series[1]),
            "without skipping / with",
            difference == 0 ? "same picture" : fmt::format("PICTURES DIFFER by {:.1e}", difference)};
}

}  // namespace

std::vector<Case> skipping_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const char* scene : {setup.quick ? "shells256-sparse" : "shells512-sparse", "aneurism"}) {
        const std::string name = fmt::format("skipping/{}", scene);
        cases.push_back(
            {{name}, [=, &setup, scene = std::string(scene)] { return std::vector{measure(setup, scene, name)}; }});
    }
    return cases;
}

}  // namespace chiaro::bench
