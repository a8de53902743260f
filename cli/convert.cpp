// chiaro convert: volumes to NRRD and OME-Zarr, transfer functions to our JSON or ParaView's.
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <chiaro/transfer_file.h>
#include <chiaro/zarr.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "setting_flags.h"
#include "stats.h"

namespace chiaro::cli {
namespace {

struct ConvertOptions {
    std::string input, to;                     // to: empty, as the ending of OUT says
    std::string encoding, levels_by = "mean";  // encoding: empty, the usual one of the format
    std::filesystem::path output;
    SettingFlags flags;
    CommonOptions common;
};

template <class Choice>
void choose(const char* option, const std::string& text, Choice& choice) {
    if (!text.empty())
        set(Setting{option, "", "", ""}, text, fmt::format("--{} {}", option, text), ErrorCode::usage, choice);
}

Scene scene_of(const ConvertOptions& o) {
    Scene scene;
    scene.volume = o.input;
    scene.read.private_addresses = true;
    o.flags.apply(scene);
    return scene;
}

/// Brick by brick, where the input can be read so.
void convert_to_zarr(const ConvertOptions& o) {
    ZarrSettings settings;
    if (!o.encoding.empty()) choose("encoding", o.encoding, settings.encoding.emplace());
    choose("levels-by", o.levels_by, settings.levels_by);
    const Scene scene = scene_of(o);
    Job job(o.common);
    Stats stats;
    const auto source = stats.stage("read", [&] {
        auto bricks = scene.stated.spacing_mm || o.input == "-" || !moment_files(o.input).empty()
                          ? nullptr
                          : open_brick_source(o.input, scene.read);
        return bricks ? bricks : source_of(read_volume(scene, job.progress));
    });
    if (!o.common.quiet)
        for (const auto& note : source->header().notes) say(fmt::format("{}: {}", o.input, note));
    stats.stage("write", [&] { write_zarr(*source, o.output, settings, job.progress); });
    job.bar.clear();
    if (o.common.verbose) tell_stages(stats);
}

void convert_volume(const ConvertOptions& o) {
    NrrdEncoding encoding = NrrdEncoding::gzip;
    choose("encoding", o.encoding, encoding);
    const Scene scene = scene_of(o);
    Job job(o.common);
    Stats stats;
    const Volume volume = stats.stage("read", [&] { return read_volume(scene, job.progress); });
    job.bar.clear();
    if (!o.common.quiet)
        for (const auto& note : volume.notes) say(fmt::format("{}: {}", o.input, note));
    stats.stage("write", [&] { write_nrrd(volume, o.output, encoding, job.progress); });
    job.bar.clear();
    if (o.common.verbose) tell_stages(stats);
}

bool for_paraview(const ConvertOptions& o) {
    if (!o.to.empty() && o.to != "chiaro" && o.to != "paraview")
        throw Error(ErrorCode::usage, fmt::format("--to {}: must be chiaro or paraview", o.to));
    return o.to.empty() ? o.output.string().ends_with(".paraview.json") : o.to == "paraview";
}

void convert_transfer_function(const ConvertOptions& o) {
    const bool paraview = for_paraview(o);
    Statistics unit;  // there is no data to stretch a function to: its values are shares of the range
    unit.max = unit.p99 = unit.p999 = 1;
    Stats stats;
    const TransferFile file = stats.stage("read", [&] { return read_transfer_file(o.input, unit); });
    if (!o.common.quiet)
        for (const auto& note : file.notes) say(fmt::format("{}: {}", o.input, note));
    stats.stage("write", [&] {
        write_text(o.output, (paraview ? to_paraview_json(file.function) : to_json(file.function)) + "\n");
    });
    if (o.common.verbose) tell_stages(stats);
}

void run(const ConvertOptions& o) {
    if (o.input.empty()) throw Error(ErrorCode::usage, "IN is missing; see chiaro convert --help");
    if (o.output.extension() == ".zarr") {
        check_folder_of(o.output);
        return convert_to_zarr(o);
    }
    check_output(o.output, {".nrrd", ".zarr", ".json"});
    o.output.extension() == ".json" ? convert_transfer_function(o) : convert_volume(o);
}

}  // namespace

Command convert_command(CLI::App& tool) {
    const auto o = std::make_shared<ConvertOptions>();
    CLI::App* app = tool.add_subcommand(
        "convert", "Converts a volume to NRRD or OME-Zarr, or a transfer function to JSON, ours or ParaView's");
    app->add_option("IN", o->input,
                    "volume, as for render; or transfer function: FILE or FILE#NAME, a preset or a colour map");
    app->add_option("OUT", o->output,
                    "what to write: .nrrd or .zarr for a volume, .json or .paraview.json for a transfer function");
    app->add_option("--encoding", o->encoding,
                    "of NRRD raw or gzip [gzip], of OME-Zarr raw, zstd or blosc [zstd of 8 bits, else blosc]")
        ->type_name("raw|gzip|zstd|blosc");
    app->add_option("--levels-by", o->levels_by, "what coarser voxels of an OME-Zarr are of finer ones [mean]")
        ->type_name("mean|max");
    app->add_option("--to", o->to, "format of a .json [by its ending]")->type_name("chiaro|paraview");
    add_common_options(*app, o->common);
    o->flags.add_to(*app, "Volume");
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
