#include "common.h"

#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "core/did_you_mean.h"
#include "core/text.h"

namespace chiaro::cli {

void add_common_options(CLI::App& app, CommonOptions& o) {
    const std::string group = "Common";
    app.add_option("--device", o.device, "where the work is done [auto]")->type_name("auto|cpu")->group(group);
    app.add_option("--threads", o.threads, "processor threads; 0: all that the process may use [0]")
        ->type_name("N")
        ->group(group);
    app.add_option("--progress", o.progress, "progress bar on long work; auto: on a terminal [auto]")
        ->type_name("auto|always|never")
        ->group(group);
    app.add_option("--stats", o.stats, "writes times and counts as JSON")->type_name("FILE.json")->group(group);
    app.add_flag("--quiet", o.quiet, "says nothing but errors")->group(group);
    app.add_flag("--verbose", o.verbose, "tells the time of every stage")->group(group);
    app.add_option("--isa", o.isa)->group("");  // for finding faults: scalar, x86-64-v2, ...
}

Device device_of(const CommonOptions& o) {
    if (o.device.starts_with("cuda"))
        throw Error(ErrorCode::output, fmt::format("--device {}: this build has the processor only", o.device));
    if (o.device != "auto" && o.device != "cpu")
        throw Error(ErrorCode::usage, fmt::format("--device {}: must be auto or cpu{}", o.device,
                                                  did_you_mean(o.device, std::vector<std::string>{"auto", "cpu"})));
    if (o.isa.empty()) return Device::cpu(o.threads);
    Isa isa{};
    set(Setting{"isa", "", "", ""}, o.isa, "--isa " + o.isa, ErrorCode::usage, isa);
    return Device::cpu(o.threads, isa);
}

void say(std::string_view line) {
    constexpr std::size_t longest = 4000;
    fmt::print(stderr, "chiaro: {}\n", one_line(std::string(line), longest));
}

}  // namespace chiaro::cli
