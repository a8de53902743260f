// A scene that is timed, from bench/scenes.
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

/// What a row says when its volume is not there.
inline constexpr const char* no_data = "skipped: no data (CHIARO_DATA_DIR)";

/// Four azimuths of a scene, whose volume is read once for all settings that it is rendered with.
class Turntable {
public:
    static constexpr int frames = 4;

    Turntable(const Setup& setup, const std::string& name);

    bool has_data() const { return has_data_; }
    Scene& scene() { return scene_; }
    /// Processor seconds of one frame, on average over the turn; the first call reads the volume.
    double seconds_per_frame();
    std::uint64_t samples_per_frame() const { return samples_ / frames; }
    /// The pixels of the last frame, before they are rounded to 8 bits.
    const Frame& frame() const { return session_.frame(); }

private:
    Progress& progress_;
    Scene scene_;
    Session session_;
    bool has_data_, shown_ = false;
    std::uint64_t samples_ = 0;
};

}  // namespace chiaro::bench
