// Transport against light's own paths: J in the air and in matter, and pictures, by grid and iteration.
#include <chiaro/text.h>
#include <fmt/format.h>

#include "rows.h"
#include "transport_metric.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr double albedos[] = {0.5, 0.8, 0.95};
constexpr const char* probes[] = {"white", "studio"};
constexpr int grids[] = {32, 64, 128};
constexpr int iterations[] = {1, 4, 16};

/// A subject under a light, with its ground truths.
struct MeasuredLight {
    std::optional<ScatteringSubject> subject;
    std::optional<TransportErrorMetric> metric;

    MeasuredLight(const Setup& setup, const std::string& name, const ScatteringCase& which) {
        subject = find_scattering_subject(setup.device, setup.data, name, setup.progress);
        if (!subject) return;
        const TransportErrorMetric::Effort quick{.air = 32, .matter = 16, .paths = 64, .paths_a_pixel = 1};
        metric.emplace(*subject, which, setup.quick ? quick : TransportErrorMetric::Effort{}, setup.progress);
    }
    MeasuredLight(MeasuredLight&&) = delete;
};

Row light_row(const std::string& name, double share, const std::string& note = "") {
    return {name, "%", {100 * share, 100 * share, 100 * share, 1}, {}, {}, note};
}

std::string told(const MeanRadianceError& error) {
    return fmt::format("bias {:+.1f} %, noise of the ground truth {:.1f} %", 100 * error.bias, 100 * error.noise);
}

const std::vector<std::string>& quantities() {
    static const std::vector<std::string> list = [] {
        std::vector<std::string> names{"air", "air-bias", "matter", "matter-bias", "picture-single"};
        for (const int n : iterations) names.push_back(fmt::format("picture-{}", n));
        names.emplace_back("picture");
        return names;
    }();
    return list;
}

std::vector<Row> measure(const TransportErrorMetric& metric, const std::string& prefix, int grid) {
    std::vector<Row> rows;
    const TransportNodes nodes = metric.nodes(grid, {});
    for (const auto& [kind, error] : {std::pair{"air", metric.in_air(nodes)}, {"matter", metric.in_medium(nodes)}}) {
        rows.push_back(
            light_row(fmt::format("{}/{}", prefix, kind), error.relative,
                      fmt::format("{}; {} iterations, the last {:.2e}", told(error), nodes.iterations, nodes.change)));
        rows.push_back(light_row(fmt::format("{}/{}-bias", prefix, kind), error.bias));
    }
    const auto add = [&](const std::string& name, const Frame& frame) {
        const MeanRadianceError error = metric.of_image(frame);
        rows.push_back(light_row(fmt::format("{}/{}", prefix, name), error.relative, told(error)));
    };
    add("picture-single", metric.image(metric.nodes(grid, 0)));
    for (const int n : iterations) add(fmt::format("picture-{}", n), metric.image(metric.nodes(grid, n)));
    add("picture", metric.image(nodes));
    return rows;
}

}  // namespace

std::vector<Case> transport_error_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const std::string& subject : scattering_subjects())
        for (const char* probe : probes)
            for (const double albedo : albedos) {
                const ScatteringCase which{.probe = probe, .albedo = albedo};
                const Shared<std::unique_ptr<MeasuredLight>> measured(
                    [&setup, subject, which] { return std::make_unique<MeasuredLight>(setup, subject, which); });
                for (const int grid : grids) {
                    const std::string prefix = fmt::format("transport-error/{}/{}/{}/{}", subject, probe, albedo, grid);
                    Case each;
                    for (const std::string& what : quantities()) each.names.push_back(prefix + "/" + what);
                    each.measure = [=]() -> std::vector<Row> {
                        const MeasuredLight& found = **measured;
                        if (!found.metric) return {{prefix, "%", {}, {}, {}, no_data}};
                        return measure(*found.metric, prefix, grid);
                    };
                    cases.push_back(std::move(each));
                }
            }
    return cases;
}

}  // namespace chiaro::bench
