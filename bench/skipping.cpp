// What empty-space skipping saves the ray caster, and that it changes nothing else.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "turntable.h"

namespace chiaro::bench {
namespace {

/// The ray caster alone, on all views of a scene.
class Turn {
public:
    Turn(const Setup& setup, const Scene& scene) : device_(setup.device), progress_(setup.progress), scene_(scene) {
        Volume volume = read_volume(scene, progress_);
        for (int i = 0; i < turn_frames; ++i)
            cameras_.push_back(make_camera(turned(scene.camera, i), volume.geometry, volume.dimensions));
        frames_.assign(turn_frames, Frame(scene.width, scene.height));
        Shape shape;
        shape.color = scene.output.color;
        medium_ = classify(upload(device_, std::move(volume)), scene.transfer.points.value(), shape);
    }

    double milliseconds_per_frame(bool skip) {
        RaySettings settings = scene_.sampling;
        settings.skip_empty = skip;
        Lighting lighting = scene_.lighting;
        lighting.shading = Shading::none;
        const auto turn = [&] {
            for (int i = 0; i < turn_frames; ++i)
                raycast(device_, medium_, {}, lighting, cameras_[i], settings, frames_[i], progress_);
        };
        const double seconds = cpu_seconds(turn);
        progress_.check();
        return 1e3 * seconds / turn_frames;
    }

    const std::vector<Frame>& frames() const { return frames_; }

private:
    const Device device_;
    Progress& progress_;
    const Scene scene_;
    Medium medium_;
    std::vector<Camera> cameras_;
    std::vector<Frame> frames_;
};

double largest_difference(const std::vector<Frame>& a, const std::vector<Frame>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < a[i].rgba.size(); ++j)
            largest = std::max(largest, std::abs(double(a[i].rgba[j]) - double(b[i].rgba[j])));
    return largest;
}

Row measure(const Setup& setup, const Scene& scene, const std::string& name) {
    Turn turn(setup, scene);
    std::vector<Frame> with, without;
    const auto keeping = [&](bool skip, std::vector<Frame>& frames) {
        return [&turn, &frames, skip] {
            const double milliseconds = turn.milliseconds_per_frame(skip);
            frames = turn.frames();
            return milliseconds;
        };
    };
    const auto series = in_turns(setup.runs, {keeping(false, without), keeping(true, with)});
    const double difference = largest_difference(with, without);
    const std::string note = difference == 0 ? "same picture" : fmt::format("PICTURES DIFFER by {:.1e}", difference);
    return {name, "ms/frame", spread_of(series[1]), median_ratio(series[0], series[1]), "without / with", note};
}

}  // namespace

std::vector<Case> skipping_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const char* scene_name : {setup.quick ? "shells256-sparse" : "shells512-sparse", "aneurism"}) {
        const std::string name = fmt::format("skipping/{}", scene_name);
        const auto row = [&setup, name, scene = find_scene(setup, scene_name)]() -> std::vector<Row> {
            if (!scene) return {{name, "ms/frame", {}, {}, {}, no_data}};
            return {measure(setup, *scene, name)};
        };
        cases.push_back({{name}, row});
    }
    return cases;
}

}  // namespace chiaro::bench
