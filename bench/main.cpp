// chiaro-bench: how fast this build is on this machine.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <cstdlib>

#include "bench.h"
#include "cli/job.h"
#include "cli/output_file.h"
#include "cli/program.h"

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

void measure(const BenchOptions& o) {
    if (!o.json.empty()) check_output(o.json, {".json"});
    Job job(o.common);
    const char* data = std::getenv("CHIARO_DATA_DIR");
    const bench::Setup setup{.device = device_of(o.common),
                             .quick = o.quick,
                             .tool = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "chiaro",
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

void run(int argc, char** argv) {
    CLI::App app{"Measures how fast this build is here", "chiaro bench"};
    app.allow_extras();  // so that refuse_rest can say what was meant
    BenchOptions o;
    std::string names = "which benchmarks (all):";
    for (const auto& suite : bench::suites()) names += fmt::format("\n{}: {}", suite.name, suite.sentence);
    app.add_option("NAME", o.selection.suites, names);
    app.add_option("--json", o.json, "writes the rows with machine and commit")->type_name("FILE");
    app.add_option("--filter", o.selection.filter, "only rows whose name this is found in")->type_name("REGEX");
    app.add_flag("--quick", o.quick, "small volumes and pictures, to see that all works");
    add_common_options(app, o.common);
    if (!parse(app, argc, argv)) return;
    refuse_rest(app);
    measure(o);
}

}  // namespace
}  // namespace chiaro::cli

int main(int argc, char** argv) {
    return chiaro::cli::run_program([&] { chiaro::cli::run(argc, argv); });
}
