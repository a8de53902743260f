// What a command works on: a volume, or a scene file that names one.
#pragma once
#include <chiaro/session.h>

#include "job.h"
#include "setting_flags.h"
#include "stats.h"

namespace chiaro::cli {

struct SceneSource {
    std::string volume;
    std::filesystem::path scene, data;
    std::vector<std::string> channels{}, channel_transfers{};  ///< files of further ones; functions of all
    std::vector<double> channel_gains{};                       ///< of all
};

void add_scene_source(CLI::App& app, SceneSource& source);

/// The scene with the flags that win over it. Throws Error{usage} unless there is either a volume or a scene file.
Scene scene_from(const SceneSource& source, const SettingFlags& flags, const CommonOptions& common,
                 std::string_view command);

/// Reads the scene's volume into the session, and says what there is to know about it. Of a later moment the first is
/// looked at before it, and the scene gets the camera that fits that one, `all_around` as a turntable's. With `paging`
/// one that does not fit in its budget is read by bricks where its format allows.
void show(Scene& scene, Session& session, Stats& stats, Job& job, const CommonOptions& common, bool all_around = false,
          const PagingSettings* paging = nullptr);

/// Goes on to the scene's moment of the volume that is shown.
void show_moment(const Scene& scene, Session& session, Stats& stats, Job& job);

}  // namespace chiaro::cli
