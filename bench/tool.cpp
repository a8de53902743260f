// What a user waits for and pays: the tool as a program of its own, from its start to the picture in a file.
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "child.h"
#include "rows.h"

namespace chiaro::bench {
namespace {

std::vector<Row> measure_first_image(const Setup& setup, const std::string& name) {
    const TemporaryFolder folder;
    const std::string volume = folder / "volume.nrrd", image = folder / "picture.png";
    write_nrrd(make_sample("shells", 256), volume, NrrdEncoding::raw);
    const std::vector<std::string> render{
        "render", volume, "-o", image, "--quiet", "--threads", std::to_string(setup.device.threads)};
    Series cpu;
    const auto wall = [&] { return wall_seconds([&] { cpu.push_back(run_program(setup.tool, render)); }); };
    const auto series = in_turns(setup.runs, {wall});
    return {{name, "s", spread_of(series[0]), {}, {}, fmt::format("{:.2f} s of CPU time", spread_of(cpu).median)}};
}

/// 16 bits of noise and slope: what it shows does not matter.
Volume make_u16(int size) {
    Volume volume = make_volume({size, size, size}, VoxelType::u16);
    const auto voxels = volume.as<std::uint16_t>();
    for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::uint16_t((i * 2654435761u) >> 16);
    return volume;
}

/// As the program counts it: what this one holds would be laid to a child's account.
double peak_mib(const std::filesystem::path& stats) {
    std::ifstream stream(stats);
    return nlohmann::json::parse(stream).at("peak_memory_bytes").get<double>() / (1 << 20);
}

std::vector<Row> measure_memory(const Setup& setup, const std::string& name, int size) {
    const TemporaryFolder folder;
    const std::string volume = folder / "volume.nrrd", image = folder / "picture.png", stats = folder / "stats.json";
    write_nrrd(make_u16(size), volume, NrrdEncoding::raw);
    const std::vector<std::string> render{"render", volume,    "-o",      image, "--quiet",
                                          "--size", "256x192", "--stats", stats};
    const Measure peak = [&] {
        run_program(setup.tool, render);
        return peak_mib(stats);
    };
    const auto series = in_turns(setup.runs, {peak});
    const double volume_mib = double(size) * size * size * sizeof(std::uint16_t) / (1 << 20);
    return {{name, "MiB", spread_of(series[0]), spread_of(series[0]).median / volume_mib, "bytes of the volume"}};
}

}  // namespace

std::vector<Case> tool_cases(const Setup& setup) {
    const int size = setup.quick ? 256 : 512;
    const std::string first = "tool/first-picture", memory = fmt::format("tool/peak-memory/{}-u16", size);
    return {{{first}, [=, &setup] { return measure_first_image(setup, first); }},
            {{memory}, [=, &setup] { return measure_memory(setup, memory, size); }}};
}

}  // namespace chiaro::bench
