// The scenes that are timed, from bench/scenes.
#pragma once
#include <chiaro/session.h>

#include <optional>
#include <string>
#include <vector>

#include "rows.h"

namespace chiaro::bench {

/// The scenes of bench/scenes, which are part of the program.
struct SceneText {
    const char* name;
    const char* json;
};
std::vector<SceneText> scene_texts();

/// A file of the folder of real volumes; nothing when it is not there.
std::optional<std::filesystem::path> real_file(const std::filesystem::path& data, const std::string& file);

/// The transfer function of the scene of that name; nothing when there is none.
std::optional<TransferFunction> scene_function(const std::string& name);

/// A scene by its name; nothing when its volume is not there.
std::optional<Scene> find_scene(const Setup& setup, const std::string& name);

/// What a row says then.
inline constexpr const char* no_data = "skipped: no data (CHIARO_DATA_DIR)";

/// Views of a scene from all around.
inline constexpr int turn_frames = 4;
CameraSettings turned(CameraSettings camera, int frame);

/// CPU milliseconds of a frame of what the session shows, from two sides, once all but the rays is found.
double turned_frame_ms(Session& session, Scene scene, Progress& progress);

/// A scene whose volume is read once for all the settings that it is rendered with.
class Turntable {
public:
    Turntable(const Setup& setup, const Scene& scene);

    /// CPU seconds of one frame, on average over the turn.
    double seconds_per_frame(const Scene& scene);
    std::uint64_t samples_per_frame() const { return samples_ / turn_frames; }

private:
    Progress& progress_;
    Session session_;
    std::uint64_t samples_ = 0;
};

}  // namespace chiaro::bench
