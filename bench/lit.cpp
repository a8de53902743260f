// What light costs a frame, once it is found: the same view by each method and without light. Final pictures, which are
// of splines, take samples closer together where light asks for it (raycast/refinement.h).
#include <chiaro/samples.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr const char* samples[] = {"tubes", "shells", "fog"};
constexpr Method methods[] = {Method::spao, Method::histogram, Method::visibility};

constexpr Interpolation interpolations[] = {Interpolation::linear, Interpolation::cubic};

/// Frames of a sample from two sides; only the rays are cast anew.
class LitFrames {
public:
    LitFrames(const Setup& setup, const char* sample, Interpolation interpolation) : progress_(setup.progress) {
        scene_.interpolation = interpolation;
        scene_.width = setup.quick ? 128 : 640, scene_.height = setup.quick ? 96 : 480;
        scene_.illumination.histogram.radius = setup.quick ? 2 : 8;  // frames take as long with any
        Session plain(setup.device);
        plain.show(make_sample(sample, setup.quick ? 48 : 160), progress_);
        scene_.camera = plain.fit(scene_, progress_);
        for (std::size_t i = 0; i < std::size(methods); ++i) sessions_.push_back(plain.share_volume());
        sessions_.push_back(std::move(plain));
    }

    /// By methods[i]; behind the last without light.
    double milliseconds(std::size_t i) {
        Scene scene = scene_;
        scene.illumination.method = i < std::size(methods) ? methods[i] : Method::none;
        return turned_frame_ms(sessions_[i], std::move(scene), progress_);
    }

private:
    Progress& progress_;
    Scene scene_;
    std::vector<Session> sessions_;
};

std::string row_of(const char* sample, Interpolation interpolation, Method method) {
    const char* final = interpolation == Interpolation::linear ? "" : "cubic/";
    return fmt::format("lit/{}/{}{}", sample, final, to_text(method));
}

}  // namespace

std::vector<Case> lit_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const char* sample : samples)
        for (const Interpolation interpolation : interpolations) {
            std::vector<std::string> names;
            for (const Method method : methods) names.push_back(row_of(sample, interpolation, method));
            cases.push_back({names, [&setup, sample, interpolation, names] {
                                 LitFrames frames(setup, sample, interpolation);
                                 std::vector<Measure> measures;
                                 for (std::size_t i = 0; i <= std::size(methods); ++i)
                                     measures.push_back([&frames, i] { return frames.milliseconds(i); });
                                 const std::vector<Series> series = in_turns(setup.runs, measures);
                                 std::vector<Row> found;
                                 for (std::size_t i = 0; i < std::size(methods); ++i)
                                     found.push_back({names[i], "ms/frame", spread_of(series[i]),
                                                      median_ratio(series[i], series.back()), "no light"});
                                 return found;
                             }});
        }
    return cases;
}

}  // namespace chiaro::bench
