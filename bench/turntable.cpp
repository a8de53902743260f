#include "turntable.h"

#include <chiaro/error.h>

#include <algorithm>

namespace chiaro::bench {
namespace {

bool is_there(const std::string& volume, const std::filesystem::path& data) {
    if (volume.starts_with("sample:")) return true;
    std::error_code unreadable;
    return !data.empty() && std::filesystem::exists(volume, unreadable);
}

}  // namespace

std::optional<Scene> find_scene(const Setup& setup, const std::string& name) {
    for (const SceneText& text : scene_texts()) {
        if (text.name != name) continue;
        std::vector<std::string> unknown;
        Scene scene = parse_scene(text.json, setup.data, setup.data, unknown);
        if (setup.quick) scene.width /= 4, scene.height /= 4;
        return is_there(scene.volume, setup.data) ? std::optional(scene) : std::nullopt;
    }
    throw Error(ErrorCode::internal, "no scene '" + name + "' in bench/scenes");
}

CameraSettings turned(CameraSettings camera, int frame) {
    camera.azimuth_deg += 360.0 * frame / turn_frames;
    return camera;
}

Turntable::Turntable(const Setup& setup, const Scene& scene) : progress_(setup.progress), session_(setup.device) {
    session_.show(read_volume(scene, progress_), progress_);
}

double Turntable::seconds_per_frame(const Scene& scene) {
    samples_ = 0;
    const auto turn = [&] {
        for (int frame = 0; frame < turn_frames; ++frame) {
            Scene view = scene;
            view.camera = turned(scene.camera, frame);
            session_.render(view, progress_);
            samples_ += session_.render_statistics().samples;
        }
    };
    return cpu_seconds(turn) / turn_frames;
}

}  // namespace chiaro::bench
