// chiaro illuminate: what a lighting method computes for every voxel, as NRRD.
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "scene_source.h"

namespace chiaro::cli {
namespace {

struct IlluminateOptions {
    SceneSource source;
    std::string encoding = "raw";
    std::filesystem::path output;
    SettingFlags flags;
    CommonOptions common;
};

/// Whether a setting has a part in what is computed; all else describes pictures.
bool matters(std::string_view group, const Setting& setting) {
    for (std::string_view other : {"Sampling", "Camera", "Shading", "Output"})
        if (group == other) return false;
    return setting.name != "size" && !setting.name.ends_with("background");
}

/// Everything that can be refused before the work begins.
NrrdEncoding checked(const IlluminateOptions& o, const Scene& scene) {
    check_output(o.output, {".nrrd"});
    if (!o.common.stats.empty()) check_output(o.common.stats, {".json"});
    if (scene.illumination.method == Method::none)
        throw Error(ErrorCode::usage, "--lighting none computes no field; see chiaro --list-methods");
    if (!is_lit(scene.mode))
        throw Error(ErrorCode::usage, fmt::format("--mode {}: a value of a whole ray has no place that could be lit",
                                                  to_text(scene.mode)));
    NrrdEncoding encoding{};
    set(Setting{"encoding", "", "", ""}, o.encoding, "--encoding " + o.encoding, ErrorCode::usage, encoding);
    return encoding;
}

void run(const IlluminateOptions& o) {
    Scene scene = scene_from(o.source, o.flags, o.common, "illuminate");
    const NrrdEncoding encoding = checked(o, scene);
    const Device device = device_of(o.common);
    Session session(device);
    Stats stats;
    Job job(o.common);
    show(scene, session, stats, job, o.common);
    ComputedField field;
    stats.frames.push_back(Stats::frame_time([&] { field = session.compute_field(scene, job.progress); }));
    stats.stages.insert(stats.stages.end(), session.stages().begin(), session.stages().end());
    field.volume.key_values["chiaro_scene"] = to_json(seen_from(scene, o.output.parent_path()));
    stats.stages.push_back({"write", Stats::time([&] { write_nrrd(field.volume, o.output, encoding, job.progress); })});
    if (!o.common.stats.empty()) write_stats(o.common.stats, stats, device, scene);
    job.bar.clear();
    if (!o.common.quiet)
        for (const auto& note : session.notes()) say(note);
    if (o.common.verbose) tell_stages(stats, device);
}

}  // namespace

Command illuminate_command(CLI::App& tool) {
    const auto o = std::make_shared<IlluminateOptions>();
    CLI::App* app = tool.add_subcommand("illuminate", "Writes what a lighting method computes for every voxel");
    add_scene_source(*app, o->source);
    app->add_option("-o,--output", o->output, "field to write, .nrrd: what the method computes for each voxel")
        ->type_name("FIELD");
    app->add_option("--encoding", o->encoding, "of the NRRD [raw]")->type_name("raw|gzip");
    add_common_options(*app, o->common);
    o->flags.add_to(*app, matters);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
