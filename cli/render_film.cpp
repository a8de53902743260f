#include "render_film.h"

#include <chiaro/error.h>
#include <chiaro/film.h>
#include <chiaro/video.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "scene_source.h"

namespace chiaro::cli {
namespace {

bool is_video(const std::filesystem::path& path) {
    return path.extension() == ".mp4" || path.extension() == ".mkv" || path.extension() == ".webm";
}

void check_film_output(const std::string& output) {
    if (is_video(output)) return check_output(output, {".mp4", ".mkv", ".webm"});
    const FramePattern pattern(output);
    if (!pattern.has_placeholder())
        throw Error(ErrorCode::usage,
                    fmt::format("{}: a film goes into frame-{{frame:04}}.png, or into .mp4, .mkv or .webm", output));
    check_output(pattern(0), {".png"});
}

/// Whether the picture of this very scene was written before.
bool is_there(const std::filesystem::path& path, const std::string& scene) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return false;
    try {
        for (const auto& [key, text] : read_png_metadata(path))
            if (key == "chiaro") return text == scene;
    } catch (const Error&) {  // not whole
    }
    return false;
}

}  // namespace

void render_film(const std::string& file, const std::string& data, const std::string& output,
                 const PagingSettings& paging, const CommonOptions& common) {
    std::vector<std::string> unknown;
    Film film = read_film(file, data, unknown);
    if (!common.quiet)
        for (const std::string& key : unknown) say(fmt::format("{}: unknown key {}", file, key));
    check_film_output(output);
    Job job(common);
    Session session(device_of(common));
    Stats stats;
    const bool is_of_moments =
        std::ranges::any_of(film.keys, [](const Keyframe& key) { return key.scene.read.time > 0; });
    show(film.keys.front().scene, session, stats, job, common, true, is_of_moments ? nullptr : &paging);
    int moment = film.keys.front().scene.read.time;
    // What the camera fits is found once, for all keys that do not say it.
    const CameraSettings fitted = session.fit_all_around(film.keys.front().scene, job.progress);
    for (Keyframe& key : film.keys)
        if (key.scene.camera.fit == Fit::visible && !key.scene.camera.fit_centre)
            key.scene.camera.fit_centre = fitted.fit_centre, key.scene.camera.fit_radius_mm = fitted.fit_radius_mm;
    const auto [dimensions, geometry] = session.finest();
    const auto render = [&](const Scene& scene) -> const Image& {
        if (scene.read.time != moment) show_moment(scene, session, stats, job);
        moment = scene.read.time;
        return session.render(scene, job.progress);
    };
    std::optional<VideoWriter> video;
    if (is_video(output)) video.emplace(output, film.width, film.height, film.fps);
    const int count = frame_count(film);
    for (int frame = 0; frame < count; ++frame) {
        const Scene scene = frame_of(film, geometry, dimensions, frame);
        if (video) {
            video->write(render(scene));
            continue;
        }
        const std::filesystem::path path = FramePattern(output)(frame);
        const std::string told = to_json(seen_from(scene, path.parent_path()));
        if (!is_there(path, told)) write_png(render(scene), path, {{"chiaro", told}}, &job.progress);
    }
    if (video) video->finish();
    job.bar.clear();
    if (!common.quiet) say(fmt::format("{} frames of {} x {}, {} a second", count, film.width, film.height, film.fps));
}

}  // namespace chiaro::cli
