// Multiple scattering by iterated sweeps: what each part costs, and how soon an edit is lit.
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <fmt/format.h>

#include <cstring>

#include "classify/medium.h"
#include "edits.h"
#include "illumination/transport/transport.h"
#include "illumination/transport/uncollided_light.h"
#include "rows.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr Vec3 up{0, 0, 1};

/// A volume lit through: fog about a ball, or a room.
Medium medium_of(const Setup& setup, const std::string& sample) {
    const int size = setup.quick ? 48 : 256;
    return classify(upload(setup.device, make_sample(sample, size)), sample_transfer_function(sample), Shape{});
}

TransportSettings settings_of(int grid) { return {.grid = grid, .error = 1e-9}; }

TransportSolver solver_of(const Setup& setup, const Medium& medium, int grid) {
    return TransportSolver(setup.device, medium.data(), Lighting(), settings_of(grid), ScatteringSettings(), up,
                           setup.progress);
}

/// A copy of J of all cells in single precision: what times are told in.
Measure copy_of_field(std::size_t cells) {
    auto from = std::make_shared<std::vector<float>>(3 * cells, 1.0f),
         to = std::make_shared<std::vector<float>>(3 * cells);
    return [=] { return cpu_seconds([&] { std::memcpy(to->data(), from->data(), 3 * cells * sizeof(float)); }); };
}

/// Moments of an edit: wall and CPU time when the first frame is there (of a grid half as fine, with the detail
/// of the light before), the first of the grid asked for, and the last.
struct Edited {
    std::vector<double> wall, cpu;  ///< ms, of each frame
};

/// What is drawn whenever there is better light: a picture as one sees it, or one that costs next to nothing.
struct Picture {
    std::string row;
    int width, height;
};
const Picture frame{"/frame", 1024, 768}, speck{"/light", 16, 12};
constexpr const char* head = "head_ct_512.nrrd";

/// A session whose scene is edited back and forth; frames are drawn as they come.
class EditedSession {
public:
    /// `name`: of a sample, or of a file.
    EditedSession(const Setup& setup, const std::string& name, int grid, const Picture& picture)
        : session_(setup.device), progress_(setup.progress) {
        if (name == head) {
            session_.show(read_volume((setup.data / head).string(), {}, progress_), progress_);
        } else {
            session_.show(make_sample(name, setup.quick ? 48 : 256), progress_);
            scene_.transfer.points = sample_transfer_function(name);
        }
        scene_.illumination.method = Method::transport;
        scene_.illumination.transport.grid = grid;
        scene_.illumination.transport.error = 0.003;  // some iterations after the first four
        scene_.width = picture.width, scene_.height = picture.height;
        if (setup.quick) scene_.width = std::min(scene_.width, 64), scene_.height = std::min(scene_.height, 48);
        edit();
    }
    Edited edit() {
        scene_.transfer.opacity_scale = scene_.transfer.opacity_scale == 1 ? 0.9 : 1;
        const Clock wall = Clock::wall(), cpu = Clock::cpu();
        Edited found;
        const auto keep = [&] { found.wall.push_back(wall.ms()), found.cpu.push_back(cpu.ms()); };
        session_.render(scene_, progress_, [&](const Image&) { keep(); });
        keep();
        return found;
    }

private:
    Session session_;
    Scene scene_;
    Progress& progress_;
};

/// Sweeps alone: uncollided light in 200 directions, then four iterations of 24; and one iteration.
std::vector<Row> measure_sweeps(const Setup& setup, const std::string& name, const std::string& sample, int grid) {
    const Medium medium = medium_of(setup, sample);
    const LightGrid cells = light_grid(medium.data(), grid, 0.9, setup.device, setup.progress);
    const OpaqueCells opaque(cells, opaque_from, setup.device);
    const SweptMedium swept(cells, opaque);
    const Geometry& geometry = medium.data().volume.data().geometry;
    const auto first = [&] {
        uncollided_light(setup.device, swept, FirstDirections(Lighting(), up, geometry, 200), setup.progress);
    };
    TransportSolver solver = solver_of(setup, medium, grid);
    const auto one = [&] { solver.iterate(setup.progress); };
    const std::size_t count = cells.extinction.grid.size();
    const auto series = in_turns(
        setup.runs, {[&] { return cpu_seconds(first); }, [&] { return cpu_seconds(one); }, copy_of_field(count)});
    Series all;
    for (std::size_t i = 0; i < series[0].size(); ++i) all.push_back(series[0][i] + 4 * series[1][i]);
    const auto row = [&](const std::string& what, const Series& seconds, const std::string& note) {
        Spread ms = spread_of(seconds);
        ms.median *= 1e3, ms.min *= 1e3, ms.max *= 1e3;
        return Row{name + what, "CPU ms", ms, median_ratio(seconds, series[2]), "memcpy of the float32 field", note};
    };
    return {row("/sweeps", all, fmt::format("{} cells, 200 + 4 × 24 directions", count)),
            row("/iteration", series[1], "24 directions, three channels")};
}

/// From an edit of the transfer function to a lit field: classified, light grid, uncollided light, four iterations from
/// the light before; then what one more costs.
std::vector<Row> measure_update(const Setup& setup, const std::string& name, const std::string& sample, int grid) {
    const Medium before = medium_of(setup, sample);
    TransportSolver warm = solver_of(setup, before, grid);
    for (int i = 0; i < 4; ++i) warm.iterate(setup.progress);
    const TransferFunction tf = sample_transfer_function(sample);
    const auto edit = [&] {
        const Medium medium = classify(before.data().volume, tf, Shape{});
        const TransportNodes light = warm.nodes();
        TransportSolver solver(setup.device, medium.data(), Lighting(), settings_of(grid), ScatteringSettings(), up,
                               setup.progress, &light);
        for (int i = 0; i < 4; ++i) solver.iterate(setup.progress);
        solver.nodes();
    };
    const auto refine = [&] {
        warm.iterate(setup.progress);
        warm.nodes();
    };
    const auto series =
        in_turns(setup.runs, {[&] { return 1e3 * wall_seconds(edit); }, [&] { return 1e3 * cpu_seconds(edit); },
                              [&] { return 1e3 * wall_seconds(refine); }, [&] { return 1e3 * cpu_seconds(refine); }});
    const auto row = [&](const std::string& what, const Series& wall, const Series& cpu) {
        return Row{name + what, "wall ms", spread_of(wall),
                   {},          {},        fmt::format("{:.0f} core-ms", spread_of(cpu).median)};
    };
    return {row("/edit", series[0], series[1]), row("/refinement", series[2], series[3])};
}

/// The same as one sees it: from an edit to a frame lit by a grid half as fine, to one of the grid asked for, and what
/// a frame of one more iteration takes.
std::vector<Row> measure_frames(const Setup& setup, const std::string& name, const std::string& sample, int grid,
                                const Picture& picture) {
    if (sample == head && !real_file(setup.data, head)) return {{name + picture.row, "wall ms", {}, {}, {}, no_data}};
    EditedSession session(setup, sample, grid, picture);
    Series wall[3], cpu[3];
    std::size_t frames = 0;
    for (int run = -1; run < setup.runs; ++run) {
        const Edited edited = session.edit();
        const std::size_t first = grid > 16 ? 1 : 0, last = edited.wall.size() - 1;
        frames = last - first;
        if (run < 0) continue;
        const auto add = [&](Series* to, const std::vector<double>& ms) {
            to[0].push_back(ms[0]), to[1].push_back(ms[first]);
            to[2].push_back((ms[last] - ms[first]) / double(std::max<std::size_t>(frames, 1)));
        };
        add(wall, edited.wall), add(cpu, edited.cpu);
    }
    const auto row = [&](const std::string& what, int i, const std::string& note) {
        return Row{name + picture.row + what,
                   "wall ms",
                   spread_of(wall[i]),
                   {},
                   {},
                   fmt::format("{:.0f} core-ms; {}", spread_of(cpu[i]).median, note)};
    };
    return {row("-coarse", 0, "from the edit; grid half as fine, detail from before"), row("", 1, "from the edit"),
            row("-refinement", 2, fmt::format("each of {} more", frames))};
}

}  // namespace

std::vector<Case> transport_cases(const Setup& setup) {
    std::vector<Case> cases;
    const auto add_frames = [&](const std::string& name, const std::string& sample, int grid, const Picture& picture) {
        const std::string row = name + picture.row;
        cases.push_back({{row + "-coarse", row, row + "-refinement"},
                         [=, &setup] { return measure_frames(setup, name, sample, grid, picture); }});
    };
    const auto grids = setup.quick ? std::vector{16} : std::vector{64, 128};
    for (const std::string sample : {"shells", "cornell"})
        for (int grid : grids) {
            const std::string name = fmt::format("transport/{}/{}", sample, grid);
            cases.push_back({{name + "/sweeps", name + "/iteration"},
                             [=, &setup] { return measure_sweeps(setup, name, sample, grid); }});
            cases.push_back({{name + "/edit", name + "/refinement"},
                             [=, &setup] { return measure_update(setup, name, sample, grid); }});
            for (const Picture& picture : {frame, speck}) add_frames(name, sample, grid, picture);
        }
    if (setup.quick) return cases;
    for (const Picture& picture : {frame, speck}) add_frames("transport/head_ct_512/64", head, 64, picture);
    const auto add_edits = [&](const std::string& row, const std::string& volume, auto edit) {
        const IlluminationSettings settings{.method = Method::transport, .transport = {.grid = 64, .error = 0.003}};
        cases.push_back(
            {{row, row + "/coarse"}, [=, &setup] { return measure_edits(setup, row, volume, 256, settings, edit); }});
    };
    for (const std::string volume : {"shells", "fog", "head_ct_512"})
        add_edits("transport/update/64/edits/" + volume, volume, edited);
    for (const std::string volume : {"shells", "head_ct_512"})
        add_edits("transport/update/64/colours/" + volume, volume, recoloured);
    return cases;
}

}  // namespace chiaro::bench
