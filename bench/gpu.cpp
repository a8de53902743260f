// A GPU: what its memory gives, and frames on it by the clock on the wall, against one pass over the voxels there.
#include <chiaro/samples.h>
#include <fmt/format.h>

#include "classify/medium.h"
#include "gpu.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/gpu.h"
#include "illumination/transport/solver.h"
#include "illumination/visibility/sweep.h"
#include "illumination/visibility/walk.h"
#include "random_codewords.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

/// Moves `bytes` over and over, waiting at the end; bytes a second / 10⁹.
double rate(cuda::Stream& stream, std::size_t bytes, const std::function<void()>& move) {
    constexpr int times = 4;
    const auto work = [&] {
        for (int i = 0; i < times; ++i) move();
        stream.wait();
    };
    return 1e-9 * times * double(bytes) / wall_seconds(work);
}

std::vector<Row> measure_memory(const Setup& setup, const std::vector<std::string>& names) {
    std::vector<Row> rows;
    if (!setup.device.has_gpu()) {
        for (const auto& name : names) rows.push_back(skipped(name, "GB/s", no_gpu));
        return rows;
    }
    cuda::Stream& stream = *setup.device.stream;
    const std::size_t bytes = std::size_t(setup.quick ? 64 : 1024) << 20;
    const cuda::Array<std::byte> from(stream, bytes), to(stream, bytes);
    std::byte* landing = stream.landing(bytes);
    const auto series = in_turns(
        setup.runs, {[&] { return rate(stream, bytes, [&] { stream.copy(to.data(), from.data(), bytes); }); },
                     [&] { return rate(stream, bytes, [&] { stream.upload(to.data(), landing, bytes); }); },
                     [&] { return rate(stream, bytes, [&] { stream.download(landing, to.data(), bytes); }); }});
    for (std::size_t i = 0; i < names.size(); ++i) {
        rows.push_back({names[i], "GB/s", spread_of(series[i])});
        if (i > 0) rows.back().ratio = median_ratio(series[i], series[0]), rows.back().to = names[0];
    }
    return rows;
}

/// A session whose every render is a frame from elsewhere.
class Turning {
public:
    Turning(const Setup& setup, const Scene& scene) : progress_(setup.progress), session_(setup.device), scene_(scene) {
        session_.show(read_volume(scene, progress_), progress_);
    }
    double frame_ms() {
        scene_.camera.azimuth_deg += 37;
        return 1e3 * wall_seconds([&] { session_.render(scene_, progress_); });
    }
    /// Of the last frame, the ray caster's part: the frame stays on the GPU, and developing brings the picture.
    double raycast_ms() const { return stage_ms("raycast"); }
    /// Of a frame after an edit of the transfer function, the steps whose names begin so, with what travels to and from
    /// the GPU.
    double edited_ms(const std::string& steps) {
        scene_.transfer.opacity_scale = scene_.transfer.opacity_scale == 1 ? 0.99 : 1;
        session_.render(scene_, progress_);
        return stage_ms(steps);
    }
    std::size_t voxel_bytes() const { return session_.volume().bytes(); }

private:
    double stage_ms(const std::string& names) const {
        double seconds = 0;
        for (const Stage& stage : session_.stages())
            if (stage.name.starts_with(names)) seconds += stage.seconds;
        return 1e3 * seconds;
    }

    Progress& progress_;
    Session session_;
    Scene scene_;
};

std::vector<Row> measure_scene(const Setup& setup, const std::vector<std::string>& names, const std::string& scene_name,
                               Method method) {
    std::vector<Row> rows;
    auto scene = find_scene(setup, scene_name);
    if (!scene || !setup.device.has_gpu()) {
        for (const auto& name : names) rows.push_back(skipped(name, "ms", scene ? no_gpu : no_data));
        return rows;
    }
    scene->illumination.method = method;
    scene->illumination.reference.rays = 1;
    Turning turning(setup, *scene);
    const auto series = in_turns(setup.runs, {[&] { return turning.frame_ms(); }, [&] { return turning.raycast_ms(); },
                                              [&] { return pass_ms(setup, turning.voxel_bytes()); }});
    for (int i = 0; i < 2; ++i)
        rows.push_back(
            {names[i], "ms", spread_of(series[i]), median_ratio(series[i], series[2]), "a pass over the voxels"});
    return rows;
}

/// One of the steps that an edit brings about.
std::vector<Row> measure_edit(const Setup& setup, const std::string& name, const std::string& scene_name,
                              const std::string& steps) {
    auto scene = find_scene(setup, scene_name);
    if (!scene || !setup.device.has_gpu()) return {skipped(name, "ms", scene ? no_gpu : no_data)};
    scene->illumination.method = steps == "density"    ? Method::visibility
                                 : steps == "classify" ? Method::none
                                                       : Method::spao;
    Turning turning(setup, *scene);
    const auto series = in_turns(
        setup.runs, {[&] { return turning.edited_ms(steps); }, [&] { return pass_ms(setup, turning.voxel_bytes()); }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "a pass over the voxels"}};
}

/// The table that an edit renews for local histograms.
std::vector<Row> measure_codewords(const Setup& setup, const std::string& name) {
    if (!setup.device.has_gpu()) return {skipped(name, "ms", no_gpu)};
    const RandomCodewords words(setup);
    words.sum(setup.device);  // the words go up once
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * wall_seconds([&] { words.sum(setup.device); }); },
                                              [&] { return pass_ms(setup, words.bytes()); }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "a pass over the words"}};
}

void add_scene(const Setup& setup, const std::string& scene, Method method, std::vector<Case>& cases) {
    const std::string of = fmt::format("{}/{}", scene, method == Method::reference ? "path" : "none");
    const std::vector<std::string> names{"gpu/frame/" + of, "gpu/raycast/" + of};
    cases.push_back({names, [=, &setup] { return measure_scene(setup, names, scene, method); }});
}

/// Light in a box with walls: that not yet scattered, of 200 directions, an iteration of 24, and the one with four of
/// the other.
std::vector<Row> measure_transport(const Setup& setup, const std::vector<std::string>& names) {
    std::vector<Row> rows;
    if (!setup.device.has_gpu()) {
        for (const auto& name : names) rows.push_back(skipped(name, "ms", no_gpu));
        return rows;
    }
    const int size = setup.quick ? 24 : 128;
    const Device& device = setup.device;
    const Medium medium =
        classify(upload(device, make_sample("cornell", size)), sample_transfer_function("cornell"), Shape{});
    const Vec3 up{0, 0, 1};
    const LightGrid grid = light_grid(medium.data(), size, 0.9, device, setup.progress);
    const OpaqueCells opaque(grid, opaque_from, device);
    const SweptMedium swept(grid, opaque);
    const FirstDirections directions(Lighting(), up, medium.data().volume.data().geometry, 200);
    const auto first = [&] { GpuTransport(device, swept).start(device, directions, setup.progress); };
    TransportSolver solver(device, medium.data(), {}, {.grid = size, .error = 1e-9}, {}, up, setup.progress);
    const auto iteration = [&] { solver.iterate(setup.progress); };
    auto series =
        in_turns(setup.runs, {[&] { return 1e3 * wall_seconds(first); }, [&] { return 1e3 * wall_seconds(iteration); },
                              [&] { return pass_ms(setup, grid.extinction.grid.size() * sizeof(float[3])); }});
    series.insert(series.begin() + 2, Series());  // with four iterations
    for (std::size_t run = 0; run < series[0].size(); ++run) series[2].push_back(series[0][run] + 4 * series[1][run]);
    for (std::size_t i = 0; i < names.size(); ++i)
        rows.push_back({names[i], "ms", spread_of(series[i]), median_ratio(series[i], series[3]), "a pass over J"});
    return rows;
}

/// 16 coefficients of 400 directions, which stay there.
std::vector<Row> measure_visibility(const Setup& setup, const std::vector<std::string>& names) {
    std::vector<Row> rows;
    if (!setup.device.has_gpu()) {
        for (const auto& name : names) rows.push_back(skipped(name, "ms", no_gpu));
        return rows;
    }
    const Device& device = setup.device;
    const Medium medium = classify(upload(device, make_sample("tubes", setup.quick ? 24 : 128)),
                                   sample_transfer_function("tubes"), Shape{});
    const Density density = density_for(medium.data(), 1, device, setup.progress);
    const auto directions = fibonacci_directions(400);
    const auto swept = [&](SweepLattice lattice) {
        return 1e3 * wall_seconds([&] { sweep_on_gpu(device, density, directions, 16, 0.5, lattice, setup.progress); });
    };
    const auto walked = [&] {
        StageTimer steps;
        const VisibilitySettings settings{.subsample = 1, .traversal = VisibilityTraversal::hierarchical};
        return 1e3 * wall_seconds([&] { walk_on_gpu(device, density, settings, 0.5, steps, setup.progress); });
    };
    const auto series =
        in_turns(setup.runs, {[&] { return swept(SweepLattice::grid); }, [&] { return swept(SweepLattice::sheared); },
                              walked, [&] { return pass_ms(setup, density.grid.size() * sizeof(float[16])); }});
    for (std::size_t i = 0; i < names.size(); ++i)
        rows.push_back({names[i], "ms", spread_of(series[i]), median_ratio(series[i], series[3]), "a pass over V"});
    return rows;
}

}  // namespace

double pass_ms(const Setup& setup, std::size_t bytes) {
    cuda::Stream& stream = *setup.device.stream;
    const cuda::Array<std::byte> from(stream, bytes), to(stream, bytes);
    return 0.5e-6 * double(bytes) / rate(stream, bytes, [&] { stream.copy(to.data(), from.data(), bytes); });
}

std::vector<Case> gpu_cases(const Setup& setup) {
    const std::vector<std::string> memory{"gpu/copy", "gpu/upload", "gpu/download"};
    std::vector<Case> cases{{memory, [=, &setup] { return measure_memory(setup, memory); }}};
    cases.push_back({{"gpu/words"}, [&setup] { return measure_codewords(setup, "gpu/words"); }});
    const std::vector<std::string> transport{"gpu/transport/first", "gpu/transport/iteration", "gpu/transport/whole"};
    cases.push_back({transport, [=, &setup] { return measure_transport(setup, transport); }});
    const std::vector<std::string> visibility{"gpu/visibility/sweep", "gpu/visibility/sheared", "gpu/visibility/walk"};
    cases.push_back({visibility, [=, &setup] { return measure_visibility(setup, visibility); }});
    for (const SceneText& text : scene_texts()) {
        for (const Method method : {Method::none, Method::reference}) add_scene(setup, text.name, method, cases);
        for (const std::string steps : {"classify", "opacity", "spao", "density"}) {
            const std::string name = fmt::format("gpu/edit/{}/{}", text.name, steps);
            cases.push_back({{name}, [=, &setup] { return measure_edit(setup, name, text.name, steps); }});
        }
    }
    for (Case& light : gpu_light_cases(setup)) cases.push_back(std::move(light));
    return cases;
}

}  // namespace chiaro::bench
