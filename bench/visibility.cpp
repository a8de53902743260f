// Visibility in spherical harmonics: the published Table 1 made again, each way's cost, and an edit's update.
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "classify/medium.h"
#include "edits.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/density.h"
#include "illumination/visibility/visibility.h"
#include "illumination/visibility/walk.h"
#include "rows.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int directions = 400;

/// The published Table 1, 8800 GTX: seconds of set-up and milliseconds a frame of 1024 × 768, by subsample.
struct PaperColumn {
    int subsample;
    double set_up_s, frame_ms;
};
constexpr PaperColumn paper_table[] = {{1, 70.4, 71}, {2, 12.3, 46}, {4, 4.0, 40}, {8, 2.3, 36}};

/// The published volumes where they are at hand, else samples of the same size.
struct SweptSubject {
    std::string name;
    Scene scene;
};

TransferFunction carp_transfer() {
    TransferFunction tf;
    tf.points = {{30, {0.5, 0.6, 0.7}, 0},      {50, {0.5, 0.6, 0.7}, 0.02},   {80, {0.9, 0.6, 0.5}, 0.08},
                 {115, {0.95, 0.9, 0.75}, 0.6}, {160, {0.95, 0.9, 0.75}, 0.9}, {254, {1, 1, 0.95}, 0.95}};
    return tf;
}

std::vector<SweptSubject> subjects(const Setup& setup) {
    std::vector<SweptSubject> list;
    const auto add = [&](const std::string& name, const std::string& file, const TransferFunction& tf,
                         const std::string& sample) {
        const auto found = real_file(setup.data, file);
        SweptSubject subject{found ? name : sample, {}};
        subject.scene.volume = found ? found->string() : fmt::format("sample:{}:{}", sample, setup.quick ? 48 : 256);
        subject.scene.transfer.points = found ? tf : sample_transfer_function(sample);
        if (setup.quick) subject.scene.width = 256, subject.scene.height = 192;
        list.push_back(subject);
    };
    add("engine", "engine.nrrd", *scene_function("engine"), "cornell");
    add("carp", "carp.nii.gz", carp_transfer(), "shells");
    return list;
}

Medium medium_of(const Setup& setup, const Scene& scene) {
    Scene read = scene;
    return classify(upload(setup.device, read_volume(read, setup.progress)), *scene.transfer.points, Shape{});
}

VisibilitySettings settings_of(int subsample, VisibilityTraversal traversal) {
    return {.directions = directions, .subsample = subsample, .traversal = traversal};
}

ShField swept(const Setup& setup, const Density& density, int subsample) {
    StageTimer timer;
    return find_visibility(setup.device, density, settings_of(subsample, VisibilityTraversal::sweep), timer,
                           setup.progress);
}

/// Seconds of the walk from all nodes, from some runs of sixteen at random.
struct Scaled {
    double seconds;
    std::size_t timed, nodes;
};
Scaled walk_seconds(const Setup& setup, const Density& density, int subsample) {
    const CellGrid& grid = density.grid;
    const int runs = setup.quick ? 8 : 512;
    Scaled scaled{0, std::size_t(runs) * std::size_t(std::min(16, grid.count[0])), grid.size()};
    std::optional<VisibilityWalk> walk;
    scaled.seconds = cpu_seconds([&] {
        walk.emplace(setup.device, density, settings_of(subsample, VisibilityTraversal::hierarchical), 0.5 / subsample,
                     setup.progress);
    });
    std::uint64_t counter = 0;
    const auto below = [&](int n) { return int(scrambled(counter++) % std::uint64_t(std::max(n, 1))); };
    const double of_runs = cpu_seconds([&] {
        VisibilityWalk::Run run;
        for (int i = 0; i < runs; ++i)
            (*walk)(below(grid.count[0] - 15), below(grid.count[1]), below(grid.count[2]), run);
    });
    scaled.seconds += of_runs * double(grid.size()) / double(scaled.timed);
    return scaled;
}

Row row_of(const std::string& name, const std::string& unit, double value, const std::string& note) {
    return {name, unit, {value, value, value, 1}, {}, {}, note};
}

std::string paper_says(double value, const char* unit) {
    return fmt::format("the published 8800 GTX: {:.1f} {}", value, unit);
}

/// An isosurface where the transfer function is half way to its most opaque.
double middle_value(const TransferFunction& tf) {
    double most = 0;
    for (const ControlPoint& p : tf.points) most = std::max(most, p.opacity);
    for (const ControlPoint& p : tf.points)
        if (p.opacity >= most / 2) return p.value;
    return tf.points.back().value;
}

/// Set-up by both ways, once.
std::vector<Row> measure_set_up(const Setup& setup, const std::string& prefix, const SweptSubject& subject,
                                const PaperColumn& paper) {
    const Medium medium = medium_of(setup, subject.scene);
    std::optional<Density> density;
    const double of_density = cpu_seconds(
        [&] { density.emplace(density_for(medium.data(), paper.subsample, setup.device, setup.progress)); });
    const double of_sweep = cpu_seconds([&] { swept(setup, *density, paper.subsample); });
    const Scaled walk = walk_seconds(setup, *density, paper.subsample);
    const std::string says = paper_says(paper.set_up_s, "s");
    return {row_of(prefix + "set-up-sweep", "CPU s", of_density + of_sweep,
                   fmt::format("{} nodes; {}", density->grid.size(), says)),
            row_of(prefix + "set-up-walk", "CPU s, scaled", of_density + walk.seconds,
                   fmt::format("from {} of {} nodes at random; {}", walk.timed, walk.nodes, says))};
}

/// CPU time of a frame from all around, its light kept.
Row frame_row(const Setup& setup, const std::string& name, Turntable& turntable, const Scene& scene,
              const PaperColumn& paper) {
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * turntable.seconds_per_frame(scene); }});
    return {name, "CPU ms/frame", spread_of(series[0]), {}, {}, paper_says(paper.frame_ms, "ms")};
}

/// The memory of the field, and pictures in its light.
std::vector<Row> measure_frames(const Setup& setup, const std::string& prefix, const SweptSubject& subject,
                                const PaperColumn& paper) {
    Scene scene = subject.scene;
    scene.illumination = {.method = Method::visibility,
                          .visibility = settings_of(paper.subsample, VisibilityTraversal::sweep)};
    std::size_t bytes = 0;
    const auto keep = [&](const IlluminationField& field) { bytes = field.bytes(); };
    illuminate(setup.device, medium_of(setup, scene), Prepared(), scene.lighting, scene.illumination, keep,
               setup.progress);
    std::vector<Row> rows{
        row_of(prefix + "memory", "MB", 1e-6 * double(bytes), "held for the ray caster, 8 bits a coefficient")};
    Turntable turntable(setup, scene);
    rows.push_back(frame_row(setup, prefix + "frame-dvr", turntable, scene, paper));
    scene.mode = Mode::iso, scene.iso = {{middle_value(*scene.transfer.points)}};
    rows.push_back(frame_row(setup, prefix + "frame-iso", turntable, scene, paper));
    return rows;
}

/// 128³ nodes of a 256³ volume in 400 directions: density and sweep against a copy of the field in single precision.
std::vector<Row> measure_sweep(const Setup& setup, const std::string& name, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    const Medium medium = classify(volume, sample_transfer_function("shells"), Shape{});
    const Density density = density_for(medium.data(), 2, setup.device, setup.progress);
    VoxelBuffer from(density.grid.size() * 16 * sizeof(float)), to(from.size());
    std::memset(from.data(), 1, from.size());
    const auto series = in_turns(
        setup.runs,
        {[&] {
             return cpu_seconds([&] { swept(setup, density_for(medium.data(), 2, setup.device, setup.progress), 2); });
         },
         [&] { return cpu_seconds([&] { std::memcpy(to.data(), from.data(), to.size()); }); }});
    const Scaled walk = walk_seconds(setup, density, 2);
    const double nodes = double(density.grid.size());
    return {{name, "CPU s", spread_of(series[0]), median_ratio(series[0], series[1]), "memcpy of the float32 field",
             fmt::format("{:.3f} us a node", 1e6 * spread_of(series[0]).median / nodes)},
            row_of(name + "/walk", "CPU s, scaled", walk.seconds,
                   fmt::format("{:.1f} us a node, from {} at random; the prototype's 48 us", 1e6 * walk.seconds / nodes,
                               walk.timed))};
}

/// What follows an edit of the transfer function: classify and illuminate.
std::vector<Row> measure_visibility_update(const Setup& setup, const std::string& name, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    const TransferFunction tf = sample_transfer_function("shells");
    IlluminationSettings settings{.method = Method::visibility,
                                  .visibility = settings_of(4, VisibilityTraversal::sweep)};
    const auto update = [&] {
        const Medium medium = classify(volume, tf, Shape{});
        illuminate(
            setup.device, medium, Prepared(), Lighting(), settings, [](const IlluminationField&) {}, setup.progress);
    };
    const auto series =
        in_turns(setup.runs, {[&] { return 1e3 * wall_seconds(update); }, [&] { return 1e3 * cpu_seconds(update); }});
    return {{name,
             "wall ms",
             spread_of(series[0]),
             {},
             {},
             fmt::format("64³ nodes; {:.0f} core-ms", spread_of(series[1]).median)}};
}

/// The density alone, beside point-classified opacity.
std::vector<Row> measure_density(const Setup& setup, const std::string& name, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    const Medium medium = classify(volume, sample_transfer_function("shells"), Shape{});
    const auto series = in_turns(
        setup.runs,
        {[&] { return 1e3 * cpu_seconds([&] { density_for(medium.data(), 1, setup.device, setup.progress); }); },
         [&] { return 1e3 * cpu_seconds([&] { cell_opacity(medium.data(), setup.progress); }); }});
    return {{name, "CPU ms", spread_of(series[0]), median_ratio(series[0], series[1]), "opacity of points"}};
}

}  // namespace

std::vector<Case> visibility_cases(const Setup& setup) {
    const int size = setup.quick ? 64 : 256;
    std::vector<Case> cases;
    const auto add = [&](const std::string& name, auto measure) {
        cases.push_back({{name}, [=, &setup] { return measure(setup, name, size); }});
    };
    add("visibility/density", measure_density);
    cases.push_back({{"visibility/128", "visibility/128/walk"},
                     [=, &setup] { return measure_sweep(setup, "visibility/128", size); }});
    add("visibility/update/64", measure_visibility_update);
    for (const std::string volume : {"shells", "fog", "head_ct_512"}) {
        if (setup.quick) break;
        const std::string row = "visibility/update/64/edits/" + volume;
        const int subsample = volume == "head_ct_512" ? 8 : 4;
        const IlluminationSettings settings{.method = Method::visibility, .visibility = {.subsample = subsample}};
        cases.push_back(
            {{row, row + "/coarse"}, [=, &setup] { return measure_edits(setup, row, volume, 256, settings); }});
    }
    for (const SweptSubject& subject : subjects(setup))
        for (const PaperColumn& paper : paper_table) {
            const std::string prefix = fmt::format("visibility/{}/1:{}/", subject.name, paper.subsample);
            cases.push_back({{prefix + "set-up-sweep", prefix + "set-up-walk"},
                             [=, &setup] { return measure_set_up(setup, prefix, subject, paper); }});
            cases.push_back({{prefix + "memory", prefix + "frame-dvr", prefix + "frame-iso"},
                             [=, &setup] { return measure_frames(setup, prefix, subject, paper); }});
        }
    return cases;
}

}  // namespace chiaro::bench
