// chiaro render: a volume or a scene to pictures.
#include <chiaro/error.h>
#include <chiaro/image.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "paging_options.h"
#include "render_film.h"
#include "scene_source.h"
#include "unused_settings.h"

namespace chiaro::cli {
namespace {

struct RenderOptions {
    SceneSource source;
    std::string output;
    std::optional<int> frames;  // none: one picture
    std::string film;           // of keyframes
    SettingFlags flags;
    PagingOptions paging;
    std::string first_picture;
    CommonOptions common;
};

bool is_exr(const std::filesystem::path& path) { return path.extension() == ".exr"; }

bool shows_nothing(const Frame& frame) {
    for (std::size_t i = 3; i < frame.rgba.size(); i += 4)
        if (frame.rgba[i] > 0) return false;
    return true;
}

/// Everything that can be refused before the work begins.
void check_options(const RenderOptions& o, const FramePattern& pattern, const Scene& scene) {
    if (o.frames && (*o.frames < 1 || *o.frames > 100000))
        throw Error(ErrorCode::usage, fmt::format("--frames {}: must be 1 to 100000", *o.frames));
    if (o.frames && (scene.camera.view || scene.camera.eye || scene.camera.matrix))
        throw Error(ErrorCode::usage,
                    "--frames turns the orbit: it goes with none of --view, --eye and --camera-matrix");
    if (pattern.is_of_moments() && (o.frames || scene.read.time > 0))
        throw Error(ErrorCode::usage,
                    fmt::format("{}: a {{t}} draws every moment: it goes with neither --frames nor --time", o.output));
    if (pattern.has_placeholder() && !pattern.is_of_moments() && !o.frames)
        throw Error(ErrorCode::usage, fmt::format("{}: a {{frame}} needs --frames N", o.output));
    check_output(pattern(0), {".png", ".exr"});
    if (is_exr(pattern(0)) && scene.output.color == ColorMode::display)
        throw Error(ErrorCode::usage,
                    fmt::format("{}: --color display gives no linear light, which .exr holds", o.output));
    if (!o.first_picture.empty()) check_output(o.first_picture, {".png"});
    if (!o.common.stats.empty()) check_output(o.common.stats, {".json"});
}

/// One command's work, from the volume to the last picture.
class Rendering {
public:
    Rendering(const RenderOptions& options)
        : o_(options),
          pattern_(options.output),
          scene_(scene_from(options.source, options.flags, options.common, "render")),
          device_(device_of(options.common)),
          paging_(paging_of(options.paging)) {
        check_options(o_, pattern_, scene_);
    }

    void run() {
        Job job(o_.common);
        if (!o_.first_picture.empty()) first_picture(job);
        show(scene_, session_, stats_, job, o_.common, o_.frames.has_value(),
             pattern_.is_of_moments() ? nullptr : &paging_);
        if (!o_.common.quiet)
            for (const auto& sentence : unused_settings(o_.flags.given(), scene_)) say(sentence);
        session_.expect_one_look();
        o_.frames ? turntable(job) : pattern_.is_of_moments() ? moments(job) : image(job);
        stats_.paging = session_.paging();
        if (!o_.common.stats.empty()) write_stats(o_.common.stats, stats_, device_, scene_);
        job.bar.clear();
        if (stats_.paths.samples && !o_.common.quiet) tell_noise(stats_.paths);
        if (!o_.common.quiet)
            for (const auto& note : session_.notes()) say(note);
        if (!o_.common.quiet && !shows_something_)
            say("nothing is visible: no matter with any opacity lies in the picture; --transfer, --window, "
                "--threshold, --iso, the clip and the camera decide that");
        if (o_.common.verbose) tell_stages(stats_, device_);
    }

private:
    FrameTime render(const Scene& scene, Job& job) {
        return Stats::frame_time([&] { session_.render(scene, job.progress); });
    }

    void keep_stages() {
        stats_.stages.insert(stats_.stages.end(), session_.stages().begin(), session_.stages().end());
    }

    void count_frame(FrameTime time) {
        time.moment = scene_.read.time;
        stats_.frames.push_back(time);
        stats_.samples += session_.render_statistics().samples;
        stats_.paths = session_.render_statistics().paths;
        shows_something_ = shows_something_ || !shows_nothing(session_.frame());
    }

    void write(const Scene& scene, int frame, Job& job) {
        const Image& image = session_.render(scene, job.progress);
        const std::filesystem::path path = pattern_(frame);
        const Metadata metadata{{"chiaro", to_json(seen_from(scene, path.parent_path()))}};
        write_seconds_ += Stats::time([&] {
            if (is_exr(path))
                write_exr(expose(session_.frame(), scene.output, &job.progress), path, metadata, &job.progress);
            else
                write_png(image, path, metadata, &job.progress);
        });
    }

    /// Of a volume that is read by bricks, by a level that takes no time.
    void first_picture(Job& job) {
        PagingSettings coarse = paging_;
        const auto source = paged_volume(scene_, coarse);
        if (!source) return;
        coarse.finest_level = std::max(coarse.finest_level, small_level(*source, source->is_far() ? 128 : 256));
        Session session(device_);
        stats_.stage("first picture", [&] {
            session.show(source, coarse, job.progress);
            write_png(session.render(scene_, job.progress), o_.first_picture, {}, &job.progress);
        });
    }

    void image(Job& job) {
        count_frame(render(scene_, job));
        scene_ = session_.as_seen(scene_);
        keep_stages();
        write(scene_, scene_.read.time, job);
        stats_.stages.push_back({"write", write_seconds_});
    }

    void moments(Job& job) {
        const int count = stats_.volume.contains("moments") ? stats_.volume["moments"]["count"].get<int>() : 1;
        image(job);
        for (int moment = 1; moment < count; ++moment) {
            scene_.read.time = moment;
            show_moment(scene_, session_, stats_, job);
            image(job);
        }
    }

    void turntable(Job& job) {
        scene_.camera = session_.fit_all_around(scene_, job.progress);
        stand_by_frame(scene_, session_.volume().geometry().world);
        Scene scene = scene_;
        const auto turn = [&](double frames) {
            scene.camera.azimuth_deg = scene_.camera.azimuth_deg + 360 * frames / *o_.frames;
        };
        turn(0.5);  // the warm-up looks from where no frame does, so that the session has nothing kept for any
        render(scene, job);
        keep_stages();
        scene.lighting.probe.exposure = scene_.lighting.probe.exposure = session_.probe_exposure();
        for (int frame = 0; frame < *o_.frames; ++frame) {
            turn(frame);
            count_frame(render(scene, job));
            if (frame == 0 || pattern_.has_placeholder()) write(scene, frame, job);
        }
        stats_.stages.push_back({"write", write_seconds_});
    }

    const RenderOptions& o_;
    const FramePattern pattern_;
    Scene scene_;
    const Device device_;
    const PagingSettings paging_;
    Session session_{device_};
    Stats stats_;
    double write_seconds_ = 0;
    bool shows_something_ = false;
};

}  // namespace

Command render_command(CLI::App& tool) {
    const auto o = std::make_shared<RenderOptions>();
    CLI::App* app = tool.add_subcommand("render", "Renders a volume or a scene to a picture");
    add_scene_source(*app, o->source);
    app->add_option("-o,--output", o->output,
                    "picture to write, .png or .exr (linear light, premultiplied); turn-{frame:03}.png keeps all "
                    "frames, beat-{t:03}.png all moments")
        ->type_name("IMAGE");
    app->add_option("--frames", o->frames,
                    "turntable of N azimuths after a warm-up; without {frame} only the first is kept")
        ->type_name("N");
    app->add_option(
           "--film", o->film,
           "keyframes (JSON, docs/scene.md), in the place of a volume: to frame-{frame:04}.png, or by ffmpeg to "
           ".mp4, .mkv or .webm")
        ->type_name("FILE");
    add_paging_options(*app, o->paging);
    app->add_option("--first-picture", o->first_picture,
                    "of a volume that is read by bricks also writes a coarse picture, as soon as there is one")
        ->type_name("FILE.png")
        ->group("Memory");
    add_common_options(*app, o->common);
    o->flags.add_to(*app);
    return {app, [o] {
                if (o->film.empty()) return Rendering(*o).run();
                if (!o->source.volume.empty() || !o->source.scene.empty() || o->frames || o->flags.any())
                    throw Error(ErrorCode::usage,
                                "--film says all of the pictures itself: it goes with --output alone");
                render_film(o->film, o->source.data.string(), o->output, paging_of(o->paging), o->common);
            }};
}

}  // namespace chiaro::cli
