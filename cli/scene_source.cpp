#include "scene_source.h"

#include <chiaro/error.h>
#include <chiaro/transfer_file.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "paging_options.h"

namespace chiaro::cli {
namespace {

void tell_guess(const Session& session, const Scene& scene) {
    const bool is_own_labels = !scene.labels.source.empty() && scene.labels.source == scene.volume;
    if (!scene.transfer.source.empty() || scene.transfer.points || scene.volume.starts_with("sample:") || is_own_labels)
        return;
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

/// ": DAPI, GFP", where the file tells them.
std::string told_names(const std::vector<Volume>& channels) {
    std::string names;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const auto& infos = channels[i].component_infos;
        if (infos.size() != 1 || infos[0].name.empty()) continue;
        names += fmt::format("{} {} is {}", names.empty() ? ":" : ",", i + 1, one_line(infos[0].name, 100));
    }
    return names;
}

/// Lists as many channels as are spoken of: the volume's own, then the files'. The list's place of each is returned.
std::vector<ChannelSettings*> listed_channels(Scene& scene, std::size_t count, std::string_view flag) {
    const auto is_own = [](const ChannelSettings& c) { return c.file.empty(); };
    const auto first_file = std::stable_partition(scene.channels.begin(), scene.channels.end(), is_own);
    const auto files = std::size_t(scene.channels.end() - first_file);
    if (count <= files)
        throw Error(ErrorCode::usage, fmt::format("{}: {} values are too few for the volume and {} other channel{}",
                                                  flag, count, files, files > 1 ? "s" : ""));
    if (count > scene.channels.size()) scene.channels.insert(first_file, count - scene.channels.size(), {});
    std::vector<ChannelSettings*> places;
    for (ChannelSettings& channel : scene.channels) places.push_back(&channel);
    return places;
}

void add_channels(const SceneSource& source, Scene& scene) {
    for (const std::string& file : source.channels) scene.channels.push_back({.file = file});
    if (!source.channel_gains.empty()) {
        const auto places = listed_channels(scene, source.channel_gains.size(), "--channel-gains");
        for (std::size_t i = 0; i < source.channel_gains.size(); ++i) {
            const double gain = source.channel_gains[i];
            if (!(gain >= 0 && gain <= 1e6))
                throw Error(ErrorCode::usage, fmt::format("--channel-gains {}: must be 0 to 1000000", gain));
            places[i]->gain = gain;
        }
    }
    if (source.channel_transfers.empty()) return;
    const auto places = listed_channels(scene, source.channel_transfers.size(), "--channel-transfers");
    for (std::size_t i = 0; i < source.channel_transfers.size(); ++i)
        if (source.channel_transfers[i] != "-") places[i]->transfer.source = source.channel_transfers[i];
}

}  // namespace

void add_scene_source(CLI::App& app, SceneSource& source) {
    app.add_option("VOLUME", source.volume,
                   "file, folder of slices, URL of an OME-Zarr, sample:NAME[:SIZE], or - for NRRD on standard input");
    app.add_option(
           "--channel", source.channels,
           "another volume, shown together with the first: extinctions add (repeatable, up to 7; docs/channels.md)")
        ->type_name("FILE")
        ->take_all();
    app.add_option("--channel-transfers", source.channel_transfers,
                   "transfer function of each channel, as --transfer; - leaves one its own colour")
        ->type_name("NAME,NAME,...")
        ->delimiter(',');
    app.add_option("--channel-gains", source.channel_gains,
                   "what each channel's extinction is multiplied by, in maxima its colour; 0 hides it")
        ->type_name("G,G,...")
        ->delimiter(',');
    app.add_option("--scene", source.scene, "scene file, instead of a VOLUME; flags beside it win")->type_name("FILE");
    app.add_option("--data", source.data, "folder where volumes of scenes are looked up after the scene's own")
        ->type_name("DIR");
}

Scene scene_from(const SceneSource& source, const SettingFlags& flags, const CommonOptions& common,
                 std::string_view command) {
    Scene scene = scene_of_volume(source.volume);
    scene.read.private_addresses = true;  // that the command line names; the read scene's are not
    if (source.volume.empty() && source.scene.empty()) {
        flags.apply(scene);
        scene.volume = scene.labels.source;  // labels alone
    }
    if (scene.volume.empty() == source.scene.empty())
        throw Error(
            ErrorCode::usage,
            fmt::format("give either a VOLUME or --scene FILE, or --labels alone; see chiaro {} --help", command));
    if (!source.scene.empty()) {
        std::vector<std::string> notes;
        scene = read_scene(source.scene, source.data, notes);
        if (!common.quiet)
            for (const auto& note : notes) say(fmt::format("{}: {}", source.scene.string(), note));
    }
    add_channels(source, scene);
    flags.apply(scene);
    return scene;
}

void show(Scene& scene, Session& session, Stats& stats, Job& job, const CommonOptions& common, bool all_around,
          const PagingSettings* paging) {
    Scene first = scene;
    first.read.time = 0;
    const auto source = paging ? paged_volume(scene, *paging) : nullptr;
    std::vector<Volume> channels;
    if (!source) channels = stats.stage("read", [&] { return read_channels(first, job.progress); });
    const Volume& header = source ? source->header() : channels.front();
    stats.volume = json_of(header);
    std::vector<std::string> notes = header.notes;
    const std::size_t channel_count = channels.size();
    for (std::size_t i = 1; i < channels.size(); ++i)
        for (const std::string& note : channels[i].notes) notes.push_back(channels[i].source + ": " + note);
    if (channel_count > 1 && !channels.front().has_own_colors)
        notes.push_back(fmt::format("{} channels are shown together{}", channel_count, told_names(channels)));
    if (source)
        session.show(source, *paging, job.progress);
    else
        session.show(std::move(channels), job.progress);
    if (scene.read.time > 0 && !source) {
        scene.camera = all_around ? session.fit_all_around(first, job.progress) : session.fit(first, job.progress);
        show_moment(scene, session, stats, job);
        notes = {fmt::format("moment {} of {}: its range, look and camera are those of moment 0", scene.read.time,
                             stats.volume["moments"]["count"].get<int>())};
    }
    job.bar.clear();
    if (common.quiet) return;
    for (const auto& note : notes) say(fmt::format("{}: {}", scene.volume, note));
    if (channel_count <= 1) tell_guess(session, scene);
    tell_transfer(session, scene);
}

void show_moment(const Scene& scene, Session& session, Stats& stats, Job& job) {
    Volume volume = stats.stage("read", [&] { return read_volume(scene, job.progress); });
    stats.volume = json_of(volume);
    session.show_moment(std::move(volume), job.progress);
}

}  // namespace chiaro::cli
