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
    if (source.volume.empty() == source.scene.empty())
        throw Error(ErrorCode::usage,
                    fmt::format("give either a VOLUME or --scene FILE; see chiaro {} --help", command));
    Scene scene = scene_of_volume(source.volume);
    if (!source.scene.empty()) {
        std::vector<std::string> unknown;
        scene = read_scene(source.scene, source.data, unknown);
        if (!common.quiet)
            for (const auto& key : unknown) say(fmt::format("{}: unknown key {}", source.scene.string(), key));
    }
    flags.apply(scene);
    return scene;
}

void show(const Scene& scene, Session& session, Stats& stats, Job& job, const CommonOptions& common,
          const PagingSettings* paging) {
    const auto source = paging ? paged_volume(scene, *paging) : nullptr;
    Volume volume;
    if (!source) stats.stages.push_back({"read", Stats::time([&] { volume = read_volume(scene, job.progress); })});
    const Volume& header = source ? source->header() : volume;
    stats.volume = json_of(header);
    const std::vector<std::string> notes = header.notes;
    if (source)
        session.show(source, *paging, job.progress);
    else
        session.show(std::move(volume), job.progress);
    job.bar.clear();
    if (common.quiet) return;
    for (const auto& note : notes) say(fmt::format("{}: {}", scene.volume, note));
    tell_guess(session, scene);
    tell_transfer(session, scene);
}

}  // namespace chiaro::cli
