// What a user waits for and pays: the tool as a program of its own, from its start to the picture in a file.
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "child.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

/// A sample's bytes as 16 bits.
Volume widened(const Volume& bytes) {
    Volume volume = make_volume(bytes.dimensions, VoxelType::u16);
    std::ranges::copy(bytes.as<std::uint8_t>(), volume.as<std::uint16_t>().begin());
    return volume;
}

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

nlohmann::json statistics_in(const std::filesystem::path& stats) {
    std::ifstream stream(stats);
    return nlohmann::json::parse(stream);
}

/// As the program counts it: what this one holds would be laid to a child's account.
double peak_mib(const std::filesystem::path& stats) {
    return statistics_in(stats).at("peak_memory_bytes").get<double>() / (1 << 20);
}

double seconds_of_reading(const std::filesystem::path& stats) {
    const nlohmann::json found = statistics_in(stats);
    for (const auto& stage : found.at("stages"))
        if (stage.at("name") == "read") return stage.at("seconds");
    return 0;
}

/// Of a file of 16-bit voxels, as it comes and with `options`, beside a second and what reading took.
std::vector<Row> measure_first_image_u16(const Setup& setup, const std::string& name, int size,
                                         const std::vector<std::string>& options) {
    const TemporaryFolder folder;
    const std::string volume = folder / "volume.nrrd", image = folder / "picture.png", stats = folder / "stats.json";
    write_nrrd(widened(make_sample("shells", size)), volume, NrrdEncoding::raw);
    std::vector<std::string> render{"render", volume, "-o", image, "--quiet", "--stats", stats};
    render.insert(render.end(), options.begin(), options.end());
    Series cpu, asked;
    const auto wall = [&] {
        const double seconds = wall_seconds([&] { cpu.push_back(run_program(setup.tool, render)); });
        asked.push_back(1 + seconds_of_reading(stats));
        return seconds;
    };
    const auto series = in_turns(setup.runs, {wall});
    asked.erase(asked.begin(), asked.end() - std::ptrdiff_t(series[0].size()));  // but those of the warm-up
    return {{name, "s", spread_of(series[0]), median_ratio(series[0], asked), "1 s and reading",
             fmt::format("{:.2f} s of CPU time", spread_of(cpu).median)}};
}

/// `what` and `voxel_bytes`: what the tool is to render, and how much the voxels of that are.
std::vector<Row> peak_row(const Setup& setup, const std::string& name, const TemporaryFolder& folder,
                          std::vector<std::string> what, double voxel_bytes) {
    const std::string image = folder / "picture.png", stats = folder / "stats.json";
    std::vector<std::string> render{"render",  "-o",      image, "--quiet",         "--size",
                                    "256x192", "--stats", stats, "--interpolation", "linear"};
    render.insert(render.end(), what.begin(), what.end());
    const Measure peak = [&] {
        run_program(setup.tool, render);
        return peak_mib(stats);
    };
    const auto series = in_turns(setup.runs, {peak});
    const double volume_mib = voxel_bytes / (1 << 20);
    return {{name, "MiB", spread_of(series[0]), spread_of(series[0]).median / volume_mib, "bytes of the volume",
             fmt::format("a volume of {:.0f} MiB", volume_mib)}};
}

double cube_bytes(int size) { return double(size) * size * size * sizeof(std::uint16_t); }

std::vector<Row> measure_memory(const Setup& setup, const std::string& name, int size) {
    const TemporaryFolder folder;
    const std::string volume = folder / "volume.nrrd";
    write_nrrd(make_u16(size), volume, NrrdEncoding::raw);
    return peak_row(setup, name, folder, {volume}, cube_bytes(size));
}

/// A scene of bench/scenes with 16 bits a voxel, lit by the default method.
std::vector<Row> measure_scene_memory(const Setup& setup, const std::string& name, const std::string& scene_name,
                                      int size) {
    const TemporaryFolder folder;
    const std::string file = folder / "scene.json";
    Scene scene = *find_scene(setup, scene_name);
    scene.volume = folder / "volume.nrrd";
    scene.illumination = {.method = Method::spao};
    write_nrrd(widened(make_sample("shells", size)), scene.volume, NrrdEncoding::raw);
    std::ofstream(file) << to_json(scene);
    return peak_row(setup, name, folder, {"--scene", file}, cube_bytes(size));
}

/// A real scan as it is rendered by default.
std::vector<Row> measure_scan_memory(const Setup& setup, const std::string& name) {
    const auto file = real_file(setup.data, "head_ct_512.nrrd");
    if (!file) return {{name, "MiB", {}, {}, {}, no_data}};
    const double bytes = double(read_volume(file->string(), {}, setup.progress).voxels.size());
    return peak_row(setup, name, TemporaryFolder(), {file->string()}, bytes);
}

}  // namespace

std::vector<Case> tool_cases(const Setup& setup) {
    const int size = setup.quick ? 256 : 512;
    const std::string first = "tool/first-picture", memory = "tool/peak-memory/", noise = fmt::format("{}-u16", size);
    std::vector<Case> cases{{{first}, [=, &setup] { return measure_first_image(setup, first); }},
                            {{memory + noise}, [=, &setup] { return measure_memory(setup, memory + noise, size); }}};
    for (const bool linear : {false, true}) {
        const std::string of_file = first + "/" + noise + (linear ? "/linear" : "");
        const std::vector<std::string> options =
            linear ? std::vector<std::string>{"--interpolation", "linear"} : std::vector<std::string>{};
        cases.push_back({{of_file}, [=, &setup] { return measure_first_image_u16(setup, of_file, size, options); }});
    }
    for (const char* look : {"sparse", "fog"}) {
        const std::string scene = fmt::format("shells{}-{}", size, look);
        cases.push_back(
            {{memory + scene}, [=, &setup] { return measure_scene_memory(setup, memory + scene, scene, size); }});
    }
    const std::string scan = memory + "head_ct_512";
    cases.push_back({{scan}, [=, &setup] { return measure_scan_memory(setup, scan); }});
    return cases;
}

}  // namespace chiaro::bench
