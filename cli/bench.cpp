// chiaro bench: how fast this build is on this machine.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "bench.h"
#include "command.h"
#include "job.h"
#include "output_file.h"

namespace chiaro::cli {
namespace {

struct BenchOptions {
    bench::Selection selection;
    std::filesystem::path json;
    bool quick = false;
    CommonOptions common;
};

/// The volumes lie in the folder itself or, beside light probes, in one of its own.
std::filesystem::path volumes_in(const std::filesystem::path& data) {
    std::error_code unreadable;
    return std::filesystem::exists(data / "volumes", unreadable) ? data / "volumes" : data;
}

void run(const BenchOptions& o) {
    if (!o.json.empty()) check_output(o.json, {".json"});
    Job job(o.common);
    const char* data = std::getenv("CHIARO_DATA_DIR");
    const bench::Setup setup{.device = device_of(o.common),
                             .quick = o.quick,
                             .tool = std::filesystem::read_symlink("/proc/self/exe"),
                             .data = volumes_in(data ? data : ""),
                             .progress = job.progress};
    std::vector<bench::Row> rows;
    if (!o.common.quiet) fmt::print("{}\n", bench::heading(setup));
    bench::run(setup, o.selection, [&](const bench::Row& row) {
        rows.push_back(row);
        job.bar.clear();
        if (!o.common.quiet) fmt::print("{}\n", bench::line_of(row));
        std::fflush(stdout);
    });
    if (!o.json.empty()) write_text(o.json, bench::to_json(setup, rows));
}

}  // namespace

Command bench_command(CLI::App& tool) {
    const auto o = std::make_shared<BenchOptions>();
    CLI::App* app = tool.add_subcommand("bench", "Measures how fast this build is here");
    std::string names = "which benchmarks (all):";
    for (const auto& suite : bench::suites()) names += fmt::format("\n{}: {}", suite.name, suite.sentence);
    app->add_option("NAME", o->selection.suites, names);
    app->add_option("--json", o->json, "writes the rows with machine and commit")->type_name("FILE");
    app->add_option("--filter", o->selection.filter, "only rows whose name this is found in")->type_name("REGEX");
    app->add_flag("--quick", o->quick, "small volumes and pictures, to see that all works");
    add_common_options(*app, o->common);
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
