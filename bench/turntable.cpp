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

/// Nothing where no scene has the name. File names are those of the folder.
std::optional<Scene> scene_named(const std::string& name, const std::filesystem::path& data) {
    for (const SceneText& text : scene_texts()) {
        if (text.name != name) continue;
        std::vector<std::string> unknown;
        return parse_scene(text.json, data, data, unknown);
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::filesystem::path> real_file(const std::filesystem::path& data, const std::string& file) {
    std::error_code unreadable;
    if (data.empty() || !std::filesystem::exists(data / file, unreadable)) return std::nullopt;
    return data / file;
}

std::optional<TransferFunction> scene_function(const std::string& name) {
    const std::optional<Scene> scene = scene_named(name, {});
    return scene ? scene->transfer.points : std::nullopt;
}

std::optional<Scene> find_scene(const Setup& setup, const std::string& name) {
    std::optional<Scene> scene = scene_named(name, setup.data);
    if (!scene) throw Error(ErrorCode::internal, "no scene '" + name + "' in bench/scenes");
    if (setup.quick) scene->width /= 4, scene->height /= 4;
    return is_there(scene->volume, setup.data) ? scene : std::nullopt;
}

CameraSettings turned(CameraSettings camera, int frame) {
    camera.azimuth_deg += 360.0 * frame / turn_frames;
    return camera;
}

double turned_frame_ms(Session& session, Scene scene, Progress& progress) {
    session.render(scene, progress);  // whatever is found once
    double seconds = 0;
    for (int frame = 0; frame < 2; ++frame) {
        scene.camera.azimuth_deg += 30;
        seconds += cpu_seconds([&] { session.render(scene, progress); });
    }
    return 1e3 * seconds / 2;
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
