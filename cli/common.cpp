#include "common.h"

#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <optional>
#include <vector>

#include "core/did_you_mean.h"
#include "core/text.h"
#include "core/thread_limit.h"
#include "progress_bar.h"

namespace chiaro::cli {

void add_common_options(CLI::App& app, CommonOptions& o) {
    const std::string group = "Common";
    app.add_option("--device", o.device, "device that does the work: the CPU or an NVIDIA GPU [auto]")
        ->type_name("auto|cpu|cuda[:N]")
        ->group(group);
    app.add_option("--threads", o.threads, "CPU threads; 0: all that the process may use [0]")
        ->type_name("N")
        ->group(group);
    app.add_option("--progress", o.progress, "progress bar on long work; auto: on a terminal [auto]")
        ->type_name("auto|always|never")
        ->group(group);
    app.add_option("--stats", o.stats, "writes times and counts as JSON")->type_name("FILE.json")->group(group);
    app.add_flag("--quiet", o.quiet, "prints results and errors only")->group(group);
    app.add_flag("--verbose", o.verbose, "prints the time of every stage")->group(group);
    app.add_option("--isa", o.isa)->group("");  // for finding faults: scalar, x86-64-v2, ...
    app.parse_complete_callback([&o] {
        limit_threads(Device::cpu(o.threads).threads);
        ProgressBar(o.progress, true);
    });
}

namespace {

Device cpu_of(const CommonOptions& o) {
    if (o.isa.empty()) return Device::cpu(o.threads);
    Isa isa{};
    set(Setting{"isa", "", "", ""}, o.isa, "--isa " + o.isa, ErrorCode::usage, isa);
    return Device::cpu(o.threads, isa);
}

/// N of "cuda:N"; "cuda" is the first.
std::optional<int> gpu_in(std::string_view name) {
    if (name == "cuda") return 0;
    if (!name.starts_with("cuda:")) return {};
    name.remove_prefix(5);
    int index = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error != std::errc() || end != name.data() + name.size() || index < 0) return {};
    return index;
}

}  // namespace

Device device_of(const CommonOptions& o) {
    const auto gpu = gpu_in(o.device);
    if (!gpu && o.device != "auto" && o.device != "cpu")
        throw Error(ErrorCode::usage,
                    fmt::format("--device {}: must be auto, cpu or cuda[:N]{}", o.device,
                                did_you_mean(o.device, std::vector<std::string>{"auto", "cpu", "cuda"})));
    const Device cpu = cpu_of(o);
    if (gpu) return Device::cuda(*gpu, cpu);
    if (o.device == "cpu") return cpu;
    const DeviceChoice choice = choose_device(cpu);
    if (!choice.sentence.empty() && !o.quiet) say(choice.sentence);
    return choice.device;
}

void say(std::string_view line) {
    constexpr std::size_t longest = 4000;
    // fmt::print would throw where standard error is full, or closed: there is nobody left to tell.
    std::fputs(fmt::format("chiaro: {}\n", one_line(line, longest)).c_str(), stderr);
}

}  // namespace chiaro::cli
