// How fast the ray caster samples where nothing can be skipped: a fog that every ray crosses whole.
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "rows.h"

namespace chiaro::bench {
namespace {

struct Direction {
    const char* name;
    double azimuth_deg, elevation_deg;
};
constexpr Direction directions[] = {{"x", 0, 0}, {"y", 90, 0}, {"z", 0, 90}, {"oblique", 35, 25}};

/// The sample `shells` in another type: its values times `factor`, and the fog that goes with them.
template <class Voxel>
Medium make_fog(const Device& device, int size, double factor) {
    const Volume shells = make_sample("shells", size);
    Volume volume = make_volume(shells.dimensions, voxel_type_of<Voxel>());
    const auto from = shells.as<std::uint8_t>();
    const auto to = volume.as<Voxel>();
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = Voxel(from[i] * factor);
    TransferFunction tf;
    tf.points = {{0, {0.3, 0.35, 0.5}, 0.0008},
                 {100 * factor, {0.25, 0.45, 0.95}, 0.004},
                 {255 * factor, {0.9, 0.25, 0.15}, 0.012}};
    return classify(upload(device, std::move(volume)), tf, Shape{});
}

/// A picture with one pixel a voxel, looking along `direction`.
class View {
public:
    View(Medium medium, int size, const Direction& direction, Progress& progress)
        : medium_(std::move(medium)), frame_(size, size), progress_(progress) {
        CameraSettings camera;
        camera.azimuth_deg = direction.azimuth_deg;
        camera.elevation_deg = direction.elevation_deg;
        camera.projection = Projection::orthographic;
        camera.zoom = std::numbers::sqrt3;
        camera_ = make_camera(camera, Geometry{}, {size, size, size});
    }

    /// Million samples a second and core.
    double rate(const Device& device) {
        Lighting lighting;
        lighting.shading = Shading::none;
        const RaySettings settings{.step_voxels = 1, .early_termination = 0, .skip_empty = false};
        RenderStatistics render_statistics;
        const double seconds = cpu_seconds(
            [&] { render_statistics = raycast(device, medium_, {}, lighting, camera_, settings, frame_, progress_); });
        progress_.check();
        return 1e-6 * double(render_statistics.samples) / seconds;
    }

private:
    Medium medium_;
    Camera camera_;
    Frame frame_;
    Progress& progress_;
};

constexpr const char* rate_unit = "M samples/s/core";
constexpr const char* not_built = "skipped: not in this build (CHIARO_KERNELS=all has it)";
constexpr const char* not_run = "skipped: this processor does not run it";
std::string row_name(const char* type, const char* direction, Isa isa) {
    return fmt::format("sampling/{}/{}/{}", type, direction, name_of(isa));
}

/// One direction with every instruction set, each against the scalar build.
Case isa_case(const Setup& setup, const char* type, const Shared<Medium>& fog, int size, const Direction& direction) {
    Case result;
    const auto isas = available_isas();
    const auto built = built_isas();
    for (Isa isa : all_isas) result.names.push_back(row_name(type, direction.name, isa));
    result.measure = [=, &progress = setup.progress, threads = setup.device.threads, runs = setup.runs,
                      names = result.names] {
        View view(*fog, size, direction, progress);
        std::vector<Measure> measures;
        for (Isa isa : isas)
            measures.push_back([&view, device = Device::cpu(threads, isa)] { return view.rate(device); });
        const auto series = in_turns(runs, measures);
        std::vector<Row> rows;
        for (std::size_t n = 0; n < names.size(); ++n) {
            const auto found = std::find(isas.begin(), isas.end(), all_isas[n]);
            if (found == isas.end()) {
                const bool is_built = std::find(built.begin(), built.end(), all_isas[n]) != built.end();
                rows.push_back({names[n], rate_unit, {}, {}, {}, is_built ? not_run : not_built});
                continue;
            }
            const auto i = std::size_t(found - isas.begin());
            rows.push_back({names[n], rate_unit, spread_of(series[i])});
            if (i > 0) rows.back().ratio = median_ratio(series[i], series[0]), rows.back().to = "scalar";
        }
        return rows;
    };
    return result;
}

/// Oblique rays against the best of the three axes.
Case direction_case(const Setup& setup, const char* type, const Shared<Medium>& fog, int size) {
    const std::string name = fmt::format("sampling/{}/oblique-to-axis", type);
    const auto measure = [=, &setup] {
        std::vector<View> views;
        for (const Direction& direction : directions) views.emplace_back(*fog, size, direction, setup.progress);
        std::vector<Measure> measures;
        for (View& view : views) measures.push_back([&view, device = setup.device] { return view.rate(device); });
        const auto series = in_turns(setup.runs, measures);
        Series best;
        for (int i = 0; i < setup.runs; ++i) best.push_back(std::max({series[0][i], series[1][i], series[2][i]}));
        return std::vector<Row>{{name, rate_unit, spread_of(series[3]), median_ratio(series[3], best), "best axis"}};
    };
    return {{name}, measure};
}

template <class Voxel>
void add_type(const Setup& setup, const char* type, double factor, std::vector<Case>& cases) {
    const int size = setup.quick ? 256 : 512;
    const Shared<Medium> fog([device = setup.device, size, factor] { return make_fog<Voxel>(device, size, factor); });
    for (const Direction& direction : directions) cases.push_back(isa_case(setup, type, fog, size, direction));
    cases.push_back(direction_case(setup, type, fog, size));
}

}  // namespace

std::vector<Case> sampling_cases(const Setup& setup) {
    std::vector<Case> cases;
    add_type<std::uint8_t>(setup, "u8", 1, cases);
    add_type<std::uint16_t>(setup, "u16", 257, cases);
    add_type<float>(setup, "f32", 1, cases);
    return cases;
}

}  // namespace chiaro::bench
