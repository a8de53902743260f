// chiaro convert: volumes to NRRD, transfer functions to our JSON.
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "setting_flags.h"

namespace chiaro::cli {
namespace {

struct ConvertOptions {
    std::string input, encoding = "gzip";
    std::filesystem::path output;
    SettingFlags flags;
    CommonOptions common;
};

void convert_volume(const ConvertOptions& o) {
    NrrdEncoding encoding{};
    set(Setting{"encoding", "", "", ""}, o.encoding, "--encoding " + o.encoding, ErrorCode::usage, encoding);
    Scene scene;
    scene.volume = o.input;
    o.flags.apply(scene);
    Job job(o.common);
    const Volume volume = read_volume(scene, job.progress);
    if (!o.common.quiet)
        for (const auto& note : volume.notes) say(fmt::format("{}: {}", o.input, note));
    write_nrrd(volume, o.output, encoding, job.progress);
}

void convert_transfer_function(const ConvertOptions& o) {
    Statistics unit;  // there is no data to stretch a preset to: its values are shares of the range
    unit.max = unit.p99 = unit.p999 = 1;
    write_text(o.output, to_json(load_transfer_function(o.input, unit)) + "\n");
}

void run(const ConvertOptions& o) {
    if (o.input.empty()) throw Error(ErrorCode::usage, "IN is missing; see chiaro convert --help");
    check_output(o.output, {".nrrd", ".json"});
    o.output.extension() == ".json" ? convert_transfer_function(o) : convert_volume(o);
}

}  // namespace

Command convert_command(CLI::App& tool) {
    const auto o = std::make_shared<ConvertOptions>();
    CLI::App* app = tool.add_subcommand("convert", "Converts a volume to NRRD, or a transfer function to JSON");
    app->add_option("IN", o->input, "volume, as for render; or transfer function: a file, a preset or a colour map");
    app->add_option("OUT", o->output, "file to write: .nrrd for a volume, .json for a transfer function");
    app->add_option("--encoding", o->encoding, "of the NRRD [gzip]")->type_name("raw|gzip");
    add_common_options(*app, o->common);
    o->flags.add_to(*app, "Volume");
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
