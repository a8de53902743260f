#include "scene_source.h"

#include <chiaro/error.h>
#include <chiaro/transfer_file.h>
#include <fmt/format.h>

#include "paging_options.h"

namespace chiaro::cli {
namespace {

void tell_guess(const Session& session, const Scene& scene) {
    if (!scene.transfer.source.empty() || scene.transfer.points || scene.volume.starts_with("sample:")) return;
    const Guess& guess = session.guess();
    say(fmt::format("looks like {} ({}): using --transfer {}", guess.modality, guess.reason, guess.preset));
}

/// What was assumed about a transfer function of another program. Errors come here, before the long work.
void tell_transfer(const Session& session, const Scene& scene) {
    const TransferSettings& transfer = scene.transfer;
    if (transfer.points || transfer.source.empty()) return;
    for (const auto& note : read_transfer_file(transfer.source, session.statistics()).notes)
        say(fmt::format("{}: {}", transfer.source, note));
}

}  // namespace

void add_scene_source(CLI::App& app, SceneSource& source) {
    app.add_option("VOLUME", source.volume,
                   "file, folder of slices, sample:NAME[:SIZE], or - for NRRD on standard input");
    app.add_option("--scene", source.scene, "scene file, instead of a VOLUME; flags beside it win")->type_name("FILE");
    app.add_option("--data", source.data, "folder where volumes of scenes are looked up after the scene's own")
        ->type_name("DIR");
}

Scene scene_from(const SceneSource& source, const SettingFlags& flags, const CommonOptions& common,
                 std::string_view command) {
    Scene scene = scene_of_volume(source.volume);
    if (source.volume.empty() && source.scene.empty()) {
        flags.apply(scene);
        scene.volume = scene.labels.source;  // labels alone
    }
    if (scene.volume.empty() == source.scene.empty())
        throw Error(
            ErrorCode::usage,
            fmt::format("give either a VOLUME or --scene FILE, or --labels alone; see chiaro {} --help", command));
    if (!source.scene.empty()) {
        std::vector<std::string> unknown;
        scene = read_scene(source.scene, source.data, unknown);
        if (!common.quiet)
            for (const auto& key : unknown) say(fmt::format("{}: unknown key {}", source.scene.string(), key));
    }
    flags.apply(scene);
    return scene;
}

void show(Scene& scene, Session& session, Stats& stats, Job& job, const CommonOptions& common, bool all_around,
          const PagingSettings* paging) {
    Scene first = scene;
    first.read.time = 0;
    const auto source = paging ? paged_volume(scene, *paging) : nullptr;
    Volume volume;
    if (!source) volume = stats.stage("read", [&] { return read_volume(first, job.progress); });
    const Volume& header = source ? source->header() : volume;
    stats.volume = json_of(header);
    std::vector<std::string> notes = header.notes;
    if (source)
        session.show(source, *paging, job.progress);
    else
        session.show(std::move(volume), job.progress);
    if (scene.read.time > 0 && !source) {
        scene.camera = all_around ? session.fit_all_around(first, job.progress) : session.fit(first, job.progress);
        show_moment(scene, session, stats, job);
        notes = {fmt::format("moment {} of {}: its range, look and camera are those of moment 0", scene.read.time,
                             stats.volume["moments"]["count"].get<int>())};
    }
    job.bar.clear();
    if (common.quiet) return;
    for (const auto& note : notes) say(fmt::format("{}: {}", scene.volume, note));
    tell_guess(session, scene);
    tell_transfer(session, scene);
}

void show_moment(const Scene& scene, Session& session, Stats& stats, Job& job) {
    Volume volume = stats.stage("read", [&] { return read_volume(scene, job.progress); });
    stats.volume = json_of(volume);
    session.show_moment(std::move(volume), job.progress);
}

}  // namespace chiaro::cli
