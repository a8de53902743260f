#include "stats.h"

#include <fmt/format.h>

#include <cmath>

#include <fstream>

#include "common.h"
#include "core/text.h"
#include "output_file.h"

namespace chiaro::cli {
namespace {

/// Not getrusage: its peak includes what the program that started this one held.
std::uint64_t peak_memory_bytes() {
    std::ifstream status("/proc/self/status");
    std::uint64_t kib = 0;
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) kib = std::stoull(line.substr(6));
    return kib * 1024;
}

}  // namespace

void tell_stages(const Stats& stats, const Device& device) {
    std::string line = fmt::format("{}{}, {} threads:", device.has_gpu() ? device.name() + ", " : "",
                                   name_of(device.isa), device.threads);
    for (const Stage& stage : stats.stages) line += fmt::format(" {} {:.3f} s", stage.name, stage.seconds);
    say(line);
}

void tell_stages(const Stats& stats) { tell_stages(stats, Device::cpu()); }

void tell_noise(const PathStatistics& paths) {
    const std::string share =
        std::isfinite(paths.relative_noise) ? fmt::format(", {:.2g} % of the light", 100 * paths.relative_noise) : "";
    say(fmt::format("{} paths a pixel; noise {:.2g}{}", paths.samples, paths.noise, share));
}

void write_stats(const std::filesystem::path& path, const Stats& stats, const Device& device, const Scene& scene) {
    Json json;
    json["chiaro"] = CHIARO_VERSION;
    json["device"] = device.name();
    json["isa"] = name_of(device.isa);
    json["threads"] = device.threads;
    json["volume"] = stats.volume;
    json["settings"] = Json::parse(to_json(scene));
    json["stages"] = Json::array();
    for (const Stage& stage : stats.stages)
        json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
    json["frames"] = Json::array();
    for (const auto& [seconds, cpu_seconds, moment] : stats.frames) {
        json["frames"].push_back({{"seconds", seconds}, {"cpu_seconds", cpu_seconds}});
        if (stats.volume.contains("moments")) json["frames"].back()["moment"] = moment;
    }
    json["samples"] = stats.samples;
    if (stats.paths.samples)
        json["paths"] = {{"samples", stats.paths.samples},
                         {"noise", stats.paths.noise},
                         {"relative_noise", stats.paths.relative_noise}};
    if (const auto& paging = stats.paging)
        json["paging"] = {{"level", paging->level},
                          {"levels", paging->levels},
                          {"dimensions", paging->dimensions},
                          {"stopped_by", paging->stopped_by},
                          {"light_level", paging->light_level},
                          {"bricks", paging->bricks},
                          {"bricks_read", paging->bricks_read},
                          {"faults", paging->faults}};
    json["peak_memory_bytes"] = peak_memory_bytes();
    write_text(path, printable_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n");
}

}  // namespace chiaro::cli
