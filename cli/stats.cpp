#include "stats.h"

#include <sys/resource.h>

#include "output_file.h"

namespace chiaro::cli {
namespace {

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace

void write_stats(const std::filesystem::path& path, const Stats& stats, const Device& device, const Scene& scene) {
    Json json;
    json["chiaro"] = CHIARO_VERSION;
    json["device"] = "cpu";
    json["isa"] = name_of(device.isa);
    json["threads"] = device.threads;
    json["volume"] = stats.volume;
    json["settings"] = Json::parse(to_json(scene));
    json["stages"] = Json::array();
    for (const Stage& stage : stats.stages)
        json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
    json["frames"] = Json::array();
    for (double seconds : stats.frame_seconds) json["frames"].push_back({{"seconds", seconds}});
    json["samples"] = stats.samples;
    json["peak_memory_bytes"] = peak_memory_bytes();
    write_text(path, json.dump(2) + "\n");
}

}  // namespace chiaro::cli
