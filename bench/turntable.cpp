#include "turntable.h"

#include <chiaro/error.h>

#include <algorithm>

namespace chiaro::bench {
namespace {

Scene scene_named(const Setup& setup, const std::string& name) {
    for (const SceneText& text : scene_texts())
        if (text.name == name) {
            std::vector<std::string> unknown;
            Scene scene = parse_scene(text.json, setup.data, setup.data, unknown);
            if (setup.quick) scene.width /= 4, scene.height /= 4;
            return scene;
        }
    throw Error(ErrorCode::internal, "no scene '" + name + "' in bench/scenes");
}

bool is_there(const std::string& volume, const std::filesystem::path& data) {
    if (volume.starts_with("sample:")) return true;
    std::error_code unreadable;
    return !data.empty() && std::filesystem::exists(volume, unreadable);
}

}  // namespace

Turntable::Turntable(const Setup& setup, const std::string& name)
    : progress_(setup.progress),
      scene_(scene_named(setup, name)),
      session_(setup.device),
      has_data_(is_there(scene_.volume, setup.data)) {}

double Turntable::seconds_per_frame() {
    if (!shown_) session_.show(read_volume(scene_, progress_), progress_), shown_ = true;
    samples_ = 0;
    return cpu_seconds([&] {
               for (int frame = 0; frame < frames; ++frame) {
                   Scene scene = scene_;
                   scene.camera.azimuth_deg += 360.0 * frame / frames;
                   session_.render(scene, progress_);
                   samples_ += session_.outcome().samples;
               }
           }) /
           frames;
}

}  // namespace chiaro::bench
