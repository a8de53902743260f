// chiaro sample: generated volumes.
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "job.h"
#include "output_file.h"
#include "stats.h"

namespace chiaro::cli {
namespace {

struct SampleOptions {
    std::string name;
    std::filesystem::path output;
    int size = 0;
    bool list = false;
    CommonOptions common;
};

void run(const SampleOptions& o) {
    if (o.list) {
        for (const auto& sample : list_samples())
            fmt::print("{:<16} {} ({}³)\n", sample.name, sample.sentence, sample.default_size);
        return;
    }
    if (o.name.empty()) throw Error(ErrorCode::usage, "NAME is missing; chiaro sample --list shows the names");
    check_output(o.output, {".nrrd"});
    Job job(o.common);
    Stats stats;
    const Volume volume = stats.stage("sample", [&] { return make_sample(o.name, o.size, job.progress); });
    stats.stage("write", [&] { write_nrrd(volume, o.output, NrrdEncoding::raw, job.progress); });
    job.bar.clear();
    if (o.common.verbose) tell_stages(stats);
}

}  // namespace

Command sample_command(CLI::App& tool) {
    const auto o = std::make_shared<SampleOptions>();
    CLI::App* app = tool.add_subcommand("sample", "Writes a generated volume");
    app->add_option("NAME", o->name, "which one; see --list");
    app->add_option("-o,--output", o->output, "volume to write, .nrrd")->type_name("FILE");
    app->add_option("--size", o->size, "voxels along each axis, 2 to 4096; 0: the sample's own [0]")->type_name("N");
    app->add_flag("--list", o->list, "lists the samples");
    add_common_options(*app, o->common);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
