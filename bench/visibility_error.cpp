// Visibility in spherical harmonics against rays: sweeps and the published way, on samples and on crops of CT.
#include <chiaro/text.h>
#include <fmt/format.h>

#include <map>

#include "rows.h"
#include "turntable.h"
#include "visibility_metric.h"

namespace chiaro::bench {
namespace {

/// A way to find V, as a row names it.
struct Way {
    std::string name;
    VisibilitySettings settings;
};

std::vector<Way> ways() {
    std::vector<Way> list;
    for (const auto traversal : {VisibilityTraversal::sweep, VisibilityTraversal::sheared,
                                 VisibilityTraversal::hierarchical, VisibilityTraversal::full})
        list.push_back({to_text(traversal), {.traversal = traversal}});
    list.push_back(
        {"hierarchical-paper", {.traversal = VisibilityTraversal::hierarchical, .model = VisibilityModel::paper}});
    list.push_back(
        {"hierarchical-jittered", {.traversal = VisibilityTraversal::hierarchical, .sampling = {.jittered = true}}});
    return list;
}

/// A subject with its ground truths, by subsample.
class MeasuredVisibility {
public:
    MeasuredVisibility(const Setup& setup, const std::string& name) : setup_(setup) {
        const int edge = setup.quick ? 32 : 64;
        lights_ = judging_lights(setup.data);
        subject_ = find_lit_subject(setup.device, setup.data, name, edge, edge, setup.progress);
    }
    explicit operator bool() const { return subject_.has_value(); }
    const std::vector<NamedLight>& lights() const { return lights_; }
    const VisibilityErrorMetric& at(int subsample) {
        const auto known = metrics_.find(subsample);
        if (known != metrics_.end()) return known->second;
        const int runs = setup_.quick ? 32 : 400, rays = setup_.quick ? 512 : 4096;
        return metrics_.emplace(subsample, VisibilityErrorMetric(*subject_, subsample, runs, rays, setup_.progress))
            .first->second;
    }

private:
    const Setup& setup_;
    std::vector<NamedLight> lights_;
    std::optional<LitSubject> subject_;
    std::map<int, VisibilityErrorMetric> metrics_;
};

/// RMSE of E by each light.
std::string light_errors(const VisibilityErrorMetric& metric, const Harmonics& found,
                         const std::vector<NamedLight>& lights) {
    std::string text;
    for (const NamedLight& light : lights)
        text += fmt::format("{}E by {} {:.2f} %", text.empty() ? "" : ", ", light.name,
                            100 * metric.light_error(found, metric.by_rays(), light.light));
    return text;
}

Row visibility_row(const std::string& name, double error, const std::string& note) {
    return {name, "%", {100 * error, 100 * error, 100 * error, 1}, {}, {}, note};
}

Row measure(const VisibilityErrorMetric& metric, const std::string& name, const Way& way,
            const std::vector<NamedLight>& lights) {
    const Harmonics found = metric.found_by(way.settings);
    return visibility_row(
        name, metric.relative_error(found, metric.by_rays()),
        fmt::format("to the full resolution {:.2f} %; {}", 100 * metric.relative_error(found, metric.in_full()),
                    light_errors(metric, found, lights)));
}

/// What four coefficients leave out of all that sixteen tell.
Row measure_bands(const VisibilityErrorMetric& metric, const std::string& name, const std::vector<NamedLight>& lights) {
    Harmonics four = metric.by_rays();
    for (RunHarmonics& run : four)
        for (int c = 4; c < max_coefficients; ++c) run[std::size_t(c)] = {};
    return visibility_row(name, metric.relative_error(four, metric.by_rays()), light_errors(metric, four, lights));
}

/// What rounding does to the sweep's coefficients.
Row measure_storage(const VisibilityErrorMetric& metric, const std::string& name, ShStorage storage,
                    const std::vector<NamedLight>& lights) {
    const VisibilitySettings settings{.model = VisibilityModel::paper, .storage = storage};
    const Harmonics exact = metric.found_by(settings), kept = metric.kept_by(settings);
    std::string note = "from single precision";
    for (const NamedLight& light : lights)
        note += fmt::format(", E by {} {:.3f} %", light.name, 100 * metric.light_error(kept, exact, light.light));
    return visibility_row(name, metric.relative_error(kept, exact), note);
}

}  // namespace

std::vector<Case> visibility_error_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const std::string& subject : lit_subjects()) {
        const Shared<MeasuredVisibility> measured([&setup, subject] { return MeasuredVisibility(setup, subject); });
        for (const int subsample : {1, 2})
            for (const Way& way : ways()) {
                const std::string name = fmt::format("visibility-error/{}/1:{}/{}", subject, subsample, way.name);
                const auto row = [=]() -> std::vector<Row> {
                    if (!*measured) return {{name, "%", {}, {}, {}, no_data}};
                    return {measure((*measured).at(subsample), name, way, (*measured).lights())};
                };
                cases.push_back({{name}, row});
            }
        const auto add = [&](const std::string& what, auto measure) {
            const std::string name = fmt::format("visibility-error/{}/{}", subject, what);
            cases.push_back({{name}, [=]() -> std::vector<Row> {
                                 if (!*measured) return {{name, "%", {}, {}, {}, no_data}};
                                 return {measure((*measured).at(1), name, (*measured).lights())};
                             }});
        };
        add("two-bands", measure_bands);
        for (const ShStorage storage : {ShStorage::u8, ShStorage::f16})
            add("kept-" + to_text(storage), [storage](const VisibilityErrorMetric& metric, const std::string& name,
                                                      const std::vector<NamedLight>& lights) {
                return measure_storage(metric, name, storage, lights);
            });
    }
    return cases;
}

}  // namespace chiaro::bench
