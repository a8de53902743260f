// Ambient occlusion by filtering: each stage and the whole, against copies of the same bytes, and the published table.
#include <chiaro/error.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <random>

#include "classify/medium.h"
#include "edits.h"
#include "illumination/access.h"
#include "illumination/soon_lit.h"
#include "illumination/spao/means.h"
#include "rows.h"
#include "turntable.h"
#include "volume/every_other.h"

namespace chiaro::bench {
namespace {

/// A classified volume, and room to copy as many bytes as it has voxels of 8 bit.
struct Subject {
    Device device;
    Medium medium;
    VoxelBuffer from, to;

    Subject(const Device& d, Medium m) : device(d), medium(std::move(m)) {
        const auto [nx, ny, nz] = medium.data().volume.dimensions();
        from = VoxelBuffer(std::size_t(nx) * ny * nz), to = VoxelBuffer(from.size());
        std::memset(from.data(), 1, from.size());
    }
    double copy_seconds(double share = 1) {
        return cpu_seconds([&] { std::memcpy(to.data(), from.data(), std::size_t(share * double(to.size()))); });
    }
    double read_seconds() const {
        const auto* words = reinterpret_cast<const std::uint64_t*>(from.data());
        volatile std::uint64_t sum = 0;  // keeps the reading
        return cpu_seconds([&] { sum = std::accumulate(words, words + from.size() / 8, std::uint64_t(0)); });
    }
};

Subject shells(const Setup& setup, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    return {setup.device, classify(volume, sample_transfer_function("shells"), Shape{})};
}

IlluminationSettings settings_of(SpaoFilter filter, SpaoModel model, double normal_factor) {
    IlluminationSettings settings{.method = Method::spao};
    settings.spao.filter = filter, settings.spao.model = model, settings.spao.normal_factor = normal_factor;
    return settings;
}

/// Opacity and accessibility of every cell, or of those near something visible.
double seconds_of(Subject& s, const IlluminationSettings& settings, bool everywhere, Progress& progress) {
    return cpu_seconds([&] {
        StageTimer timer;
        const CellOpacity opacity = cell_opacity(s.medium.data(), progress);
        const CellGrid& grid = opacity.values.grid;
        const BlockMap blocks = everywhere ? BlockMap(grid.count, true) : visible_blocks(s.medium.data(), grid, 2);
        accessibility(s.device, s.medium.data(), opacity, settings, blocks, timer, progress);
    });
}

std::vector<Row> measure_whole(const Setup& setup, const std::string& name, Subject& subject, SpaoModel model) {
    const auto settings = settings_of(SpaoFilter::automatic, model, model == SpaoModel::corrected);
    const bool everywhere = model != SpaoModel::corrected;
    const auto series =
        in_turns(setup.runs, {[&] { return 1e3 * seconds_of(subject, settings, everywhere, setup.progress); },
                              [&] { return 1e3 * subject.copy_seconds(); }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "memcpy of the u8 volume"}};
}

/// The corrected model against the paper's, in turns, where something may be visible.
std::vector<Row> measure_models(const Setup& setup, const std::string& name, Subject& subject) {
    const auto run = [&](SpaoModel model) {
        return 1e3 * seconds_of(subject, settings_of(SpaoFilter::automatic, model, model == SpaoModel::corrected),
                                model != SpaoModel::corrected, setup.progress);
    };
    const auto series =
        in_turns(setup.runs, {[&] { return run(SpaoModel::corrected); }, [&] { return run(SpaoModel::paper); }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "the published model"}};
}

/// The published figures: milliseconds on a GTX TITAN, 512³, levels 0 to 6, 512 rays.
struct PaperTable {
    double levels, access;
};
constexpr PaperTable paper_nbuffers{268.9, 63.2}, paper_mipmaps{38.8, 110.4};
constexpr double paper_rays_s = 425;
constexpr int paper_levels = 6, paper_rays = 512;

constexpr const char* two_bytes = "memcpy of 2 bytes a cell";
std::string paper_says(double ms) { return fmt::format("the published GTX TITAN at 512³: {:.1f} ms", ms); }

/// Names of the rows of `measure_levels`.
std::vector<std::string> level_rows(const std::string& prefix) {
    std::vector<std::string> names{prefix + "spao combine", prefix + "levels", prefix + "total"};
    for (int level = 0; level <= paper_levels; ++level) names.push_back(fmt::format("{}spao level {}", prefix, level));
    return names;
}

/// Stored levels: the median of every step, against a copy of as many bytes as the level has.
std::vector<Row> measure_levels(const Setup& setup, const std::string& prefix, Subject& subject, SpaoFilter filter) {
    auto settings = settings_of(filter, SpaoModel::paper, 1);
    settings.spao.levels = paper_levels;
    const PaperTable& paper = filter == SpaoFilter::nbuffer ? paper_nbuffers : paper_mipmaps;
    std::vector<std::string> names;
    std::vector<Series> times;
    Series copies;
    for (int run = -1; run < setup.runs; ++run) {
        StageTimer timer;
        const CellOpacity opacity = cell_opacity(subject.medium.data(), setup.progress);
        accessibility(subject.device, subject.medium.data(), opacity, settings,
                      BlockMap(opacity.values.grid.count, true), timer, setup.progress);
        const auto stages = timer.take();
        times.resize(stages.size()), names.resize(stages.size());
        for (std::size_t i = 0; run >= 0 && i < stages.size(); ++i) {
            names[i] = stages[i].name;
            times[i].push_back(1e3 * stages[i].seconds);
        }
        if (run >= 0) copies.push_back(2e3 * subject.copy_seconds());  // two bytes a cell
    }
    std::vector<Row> rows;
    Series levels(copies.size()), total(copies.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool is_level = names[i].find("level") != std::string::npos;
        for (std::size_t run = 0; run < copies.size(); ++run) {
            total[run] += times[i][run];
            if (is_level) levels[run] += times[i][run];
        }
        rows.push_back({prefix + names[i], "wall ms", spread_of(times[i]), median_ratio(times[i], copies), two_bytes,
                        is_level ? "" : paper_says(paper.access)});
    }
    rows.push_back({prefix + "levels", "wall ms", spread_of(levels), median_ratio(levels, copies), two_bytes,
                    paper_says(paper.levels)});
    rows.push_back({prefix + "total", "wall ms", spread_of(total), {}, {}, paper_says(paper.levels + paper.access)});
    return rows;
}

/// What levels 1 to 6 cost beyond level 0, and how many bytes they have.
struct Chain {
    double seconds;
    std::size_t bytes;
};
Chain chain_of(Subject& s, const CellOpacity& opacity, int mip_levels, Progress& progress) {
    const auto make = [&](int top) {
        Chain chain{0, 0};
        chain.seconds = cpu_seconds([&] {
            StageTimer timer;
            chain.bytes = SpaoLevels(s.device, opacity, std::min(mip_levels, top), top, timer, progress).bytes();
        });
        return chain;
    };
    const Chain all = make(paper_levels), first = make(0);
    return {std::max(all.seconds - first.seconds, 0.0), all.bytes - first.bytes};
}

/// An N-buffer against a copy of as many bytes; the chain of mipmaps against reading what it is made of.
std::vector<Row> measure_chain(const Setup& setup, const std::string& name, Subject& subject, SpaoFilter filter) {
    const bool is_nbuffer = filter == SpaoFilter::nbuffer;
    const CellOpacity opacity = cell_opacity(subject.medium.data(), setup.progress);
    std::size_t bytes = 0;
    const auto chain = [&] {
        const Chain found = chain_of(subject, opacity, is_nbuffer ? 0 : paper_levels, setup.progress);
        bytes = found.bytes;
        return 1e3 * found.seconds / (is_nbuffer ? paper_levels : 1);
    };
    const auto yardstick = [&] {
        if (!is_nbuffer) return 2e3 * subject.read_seconds();
        return 1e3 * subject.copy_seconds() * double(bytes) / double(subject.from.size()) / paper_levels;
    };
    const auto series = in_turns(setup.runs, {chain, yardstick});
    return {{name, is_nbuffer ? "ms/level" : "ms", spread_of(series[0]), median_ratio(series[0], series[1]),
             is_nbuffer ? "memcpy of a level" : "reading 2 bytes a cell"}};
}

/// Rays from the cells of a few blocks, scaled to all.
std::vector<Row> measure_rays(const Setup& setup, const std::string& name, Subject& subject) {
    const CellOpacity opacity = cell_opacity(subject.medium.data(), setup.progress);
    BlockMap some(opacity.values.grid.count);
    std::vector<std::size_t> order(some.holds.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    order.resize(std::max<std::size_t>(order.size() / 512, 1));
    for (const std::size_t block : order) some.holds[block] = 1;
    IlluminationSettings settings{.method = Method::reference};
    settings.reference.rays = setup.quick ? 16 : paper_rays;
    StageTimer timer;
    accessibility(subject.device, subject.medium.data(), opacity, settings, some, timer, setup.progress);
    double seconds = 0, share = double(order.size()) / double(some.holds.size());
    for (const Stage& stage : timer.take()) seconds += stage.name == "rays" ? stage.seconds / share : stage.seconds;
    return {
        {name,
         "wall s",
         {seconds, seconds, seconds, 1},
         {},
         {},
         fmt::format("{} rays a cell, from {} of {} blocks at random, scaled; the published GTX TITAN at 512³: {} s",
                     settings.reference.rays, order.size(), some.holds.size(), paper_rays_s)}};
}

/// What follows an edit of the transfer function: classify and illuminate; or the light that drafts of large volumes
/// are shown in.
std::vector<Row> measure_updates(const Setup& setup, const std::string& name, const std::string& volume, int size,
                                 bool is_soon, bool is_surface) {
    std::optional<EditedVolume> subject = edited_volume(setup, volume, size);
    if (!subject) return {{name, "wall ms", {}, {}, {}, no_data}};
    IlluminationSettings settings;
    settings.method = Method::spao;
    subject->is_surface = is_surface;
    if (is_soon) subject->volume = every_other_voxel(subject->volume, setup.progress);
    return measure_edits(name, *subject, [&](const Medium& medium, const std::function<void()>&) {
        if (is_soon)
            light_of_every_other_voxel(setup.device, medium, Lighting(), settings, setup.progress);
        else
            illuminate(
                setup.device, medium, Prepared(), Lighting(), settings, [](const IlluminationField&) {},
                setup.progress);
    });
}

}  // namespace

std::vector<Case> spao_cases(const Setup& setup) {
    const int size = setup.quick ? 96 : 512;
    const Shared<Subject> volume([&setup, size] { return shells(setup, size); });
    std::vector<Case> cases;
    const auto add = [&](std::string name, auto measure) {
        cases.push_back({{name}, [=, &setup] { return measure(setup, name, *volume); }});
    };
    add("spao/paper/whole", [](const Setup& s, const std::string& name, Subject& subject) {
        return measure_whole(s, name, subject, SpaoModel::paper);
    });
    add("spao/corrected/whole", [](const Setup& s, const std::string& name, Subject& subject) {
        return measure_whole(s, name, subject, SpaoModel::corrected);
    });
    add("spao/corrected-to-paper", measure_models);
    for (const SpaoFilter filter : {SpaoFilter::nbuffer, SpaoFilter::mipmap}) {
        const std::string prefix = fmt::format("spao/{}/", filter == SpaoFilter::nbuffer ? "nbuffer" : "mipmap");
        cases.push_back({level_rows(prefix), [=, &setup] { return measure_levels(setup, prefix, *volume, filter); }});
        const std::string chain = filter == SpaoFilter::nbuffer ? "spao/nbuffer-level" : "spao/mipmap-chain";
        cases.push_back({{chain}, [=, &setup] { return measure_chain(setup, chain, *volume, filter); }});
    }
    add("spao/rays", measure_rays);
    if (setup.quick) return cases;
    const auto add_updates = [&](const std::string& row, const std::string& subject, int edge, bool is_soon,
                                 bool is_surface = false) {
        cases.push_back(
            {{row}, [=, &setup] { return measure_updates(setup, row, subject, edge, is_soon, is_surface); }});
    };
    for (const int edge : {256, 512}) {
        add_updates(fmt::format("spao/update/{}", edge), "shells", edge, false);
        add_updates(fmt::format("spao/update/{}/fog", edge), "fog", edge, false);
    }
    add_updates("spao/update/512/head-ct", "head_ct_512", 512, false);
    add_updates("spao/update/512/iso", "shells", 512, false, true);
    add_updates("spao/update/512/head-ct/iso", "head_ct_512", 512, false, true);
    add_updates("spao/update/512/soon", "shells", 512, true);
    add_updates("spao/update/512/head-ct/soon", "head_ct_512", 512, true);
    return cases;
}

}  // namespace chiaro::bench
