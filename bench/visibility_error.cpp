// Visibility in spherical harmonics against rays: sweeps and the paper's way, on samples and on crops of CT.
#include <chiaro/text.h>
#include <fmt/format.h>

#include <map>

#include "rows.h"
#include "turntable.h"
#include "visibility_judge.h"

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

/// A subject with its truths, by subsample.
class JudgedVisibility {
public:
    JudgedVisibility(const Setup& setup, const std::string& name) : setup_(setup) {
        const int edge = setup.quick ? 32 : 64;
        lights_ = judging_lights(setup.data);
        subject_ = find_lit_subject(setup.device, setup.data, name, edge, edge, setup.progress);
    }
    explicit operator bool() const { return subject_.has_value(); }
    const std::vector<NamedLight>& lights() const { return lights_; }
    const VisibilityJudge& at(int subsample) {
        const auto known = judges_.find(subsample);
        if (known != judges_.end()) return known->second;
        const int runs = setup_.quick ? 32 : 400, rays = setup_.quick ? 512 : 4096;
        return judges_.emplace(subsample, VisibilityJudge(*subject_, subsample, runs, rays, setup_.progress))
            .first->second;
    }

private:
    const Setup& setup_;
    std::vector<NamedLight> lights_;
    std::optional<LitSubject> subject_;
    std::map<int, VisibilityJudge> judges_;
};

/// RMSE of E by each light.
std::string light_errors(const VisibilityJudge& judge, const Harmonics& found, const std::vector<NamedLight>& lights) {
    std::string text;
    for (const NamedLight& light : lights)
        text += fmt::format("{}E by {} {:.2f} %", text.empty() ? "" : ", ", light.name,
                            100 * judge.light_error(found, judge.by_rays(), light.light));
    return text;
}

Row visibility_row(const std::string& name, double error, const std::string& note) {
    return {name, "%", {100 * error, 100 * error, 100 * error, 1}, {}, {}, note};
}

Row measure(const VisibilityJudge& judge, const std::string& name, const Way& way,
            const std::vector<NamedLight>& lights) {
    const Harmonics found = judge.found_by(way.settings);
    return visibility_row(
        name, judge.relative_error(found, judge.by_rays()),
        fmt::format("to the full resolution {:.2f} %; {}", 100 * judge.relative_error(found, judge.in_full()),
                    light_errors(judge, found, lights)));
}

/// What four coefficients leave out of all that sixteen tell.
Row measure_bands(const VisibilityJudge& judge, const std::string& name, const std::vector<NamedLight>& lights) {
    Harmonics four = judge.by_rays();
    for (RunHarmonics& run : four)
        for (int c = 4; c < most_coefficients; ++c) run[std::size_t(c)] = {};
    return visibility_row(name, judge.relative_error(four, judge.by_rays()), light_errors(judge, four, lights));
}

/// What rounding does to the sweep's coefficients.
Row measure_storage(const VisibilityJudge& judge, const std::string& name, ShStorage storage,
                    const std::vector<NamedLight>& lights) {
    const VisibilitySettings settings{.model = VisibilityModel::paper, .storage = storage};
    const Harmonics exact = judge.found_by(settings), kept = judge.kept_by(settings);
    std::string note = "from single precision";
    for (const NamedLight& light : lights)
        note += fmt::format(", E by {} {:.3f} %", light.name, 100 * judge.light_error(kept, exact, light.light));
    return visibility_row(name, judge.relative_error(kept, exact), note);
}

}  // namespace

std::vector<Case> visibility_error_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const std::string& subject : lit_subjects()) {
        const Shared<JudgedVisibility> judged([&setup, subject] { return JudgedVisibility(setup, subject); });
        for (const int subsample : {1, 2})
            for (const Way& way : ways()) {
                const std::string name = fmt::format("visibility-error/{}/1:{}/{}", subject, subsample, way.name);
                const auto row = [=]() -> std::vector<Row> {
                    if (!*judged) return {{name, "%", {}, {}, {}, no_data}};
                    return {measure((*judged).at(subsample), name, way, (*judged).lights())};
                };
                cases.push_back({{name}, row});
            }
        const auto add = [&](const std::string& what, auto measure) {
            const std::string name = fmt::format("visibility-error/{}/{}", subject, what);
            cases.push_back({{name}, [=]() -> std::vector<Row> {
                                 if (!*judged) return {{name, "%", {}, {}, {}, no_data}};
                                 return {measure((*judged).at(1), name, (*judged).lights())};
                             }});
        };
        add("two-bands", measure_bands);
        for (const ShStorage storage : {ShStorage::u8, ShStorage::f16})
            add("kept-" + to_text(storage), [storage](const VisibilityJudge& judge, const std::string& name,
                                                      const std::vector<NamedLight>& lights) {
                return measure_storage(judge, name, storage, lights);
            });
    }
    return cases;
}

}  // namespace chiaro::bench
