#include "transport_metric.h"

#include <algorithm>
#include <cmath>

#include "classify/medium.h"
#include "core/threads.h"
#include "illumination/transport/light.h"
#include "illumination/transport/solver.h"

namespace chiaro::bench {
namespace {

/// Sums of what is compared.
struct Sums {
    double errors = 0, squares = 0, noise = 0, found = 0, ground_truth = 0;
    int count = 0;

    void add(double f, double t, double variance) {
        errors += (f - t) * (f - t), squares += t * t, noise += variance, found += f, ground_truth += t, ++count;
    }
    /// The noise adds its variance to the errors and to the ground truth's squares.
    MeanRadianceError over_squares() const {
        if (count == 0) return {};
        const double light = std::max(squares - noise, 1e-30);
        return {std::sqrt(std::max(errors - noise, 0.0) / light), (found - ground_truth) / ground_truth,
                std::sqrt(noise / light)};
    }
    MeanRadianceError over_mean() const {
        const double mean = ground_truth / count;
        return {std::sqrt(std::max(errors - noise, 0.0) / count) / mean, (found - ground_truth) / ground_truth,
                std::sqrt(noise / count) / mean};
    }
};

/// Trilinear, each node by its weight. In the air that is the fourth power of what it leaves clear, so that no air
/// takes the light within matter; where all nodes around are full of matter, those of the air farther off count, the
/// nearest most.
Rgb light_at(const TransportNodes& nodes, Vec3 p, bool in_medium) {
    const CellGrid& grid = nodes.grid;
    int low[3];
    double share[3];
    for (int a = 0; a < 3; ++a) {
        const double at = std::clamp((p[a] + 0.5) / grid.voxels_per_cell[a] - 0.5, 0.0, grid.count[a] - 1.0);
        low[a] = std::min(int(at), std::max(grid.count[a] - 2, 0)), share[a] = at - low[a];
    }
    Rgb sum{0, 0, 0};
    double weights = 0;
    const auto add = [&](int x, int y, int z, double weight) {
        const std::size_t node = grid.index(x, y, z);
        const bool is_surface = !nodes.result.empty() && nodes.result[3 * node] > 0;
        const double clear = is_surface ? 0 : std::pow(1 - double(nodes.weight[node]), 4);
        weight *= in_medium ? nodes.weight[node] : clear + 1e-6;
        weights += weight;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * nodes.light[3 * node + c];
    };
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        int cell[3];
        for (int a = 0; a < 3; ++a) {
            const bool next = corner >> a & 1;
            cell[a] = std::min(low[a] + next, grid.count[a] - 1), weight *= next ? share[a] : 1 - share[a];
        }
        add(cell[0], cell[1], cell[2], weight);
    }
    constexpr double few = 0.5;
    if (!in_medium && weights < few) {
        const auto range = [&](int a) {
            return std::pair{std::max(low[a] - 1, 0), std::min(low[a] + 2, grid.count[a] - 1)};
        };
        const auto distance = [&](int a, int cell) { return cell - low[a] - share[a]; };
        for (int z = range(2).first; z <= range(2).second; ++z)
            for (int y = range(1).first; y <= range(1).second; ++y)
                for (int x = range(0).first; x <= range(0).second; ++x) {
                    const double off = std::hypot(distance(0, x), distance(1, y), distance(2, z));
                    add(x, y, z, few * std::exp(-1.5 * off * off));
                }
    }
    for (double& channel : sum) channel /= std::max(weights, 1e-30);
    return sum;
}

/// As pictures of particles look it up.
Rgb shown_at(const ShownLight& shown, Vec3 p, double depth_of_voxel) {
    const kernel::ScatteredLight scattered{.on = true, .boundary_cells = shown.boundary_view};
    kernel::SamplePoint<float> sample{{float(p.x), float(p.y), float(p.z)}, 0};
    sample.solid = float(std::clamp(depth_of_voxel - 0.5, 0.0, 1.0));
    const auto light = scattered.incident<float>(shown.view, sample);
    return {light.x, light.y, light.z};
}

}  // namespace

MeanRadianceError error_of(const std::vector<Rgb>& found, const MeanRadiance& ground_truth) {
    Sums sums;
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            sums.add(found[i][c], ground_truth.mean[i][c], ground_truth.error[i] * ground_truth.error[i]);
    return sums.over_squares();
}

double block_mean(const Frame& frame, int block_x, int block_y, int c, int block) {
    double sum = 0;
    for (int y = block_y * block; y < (block_y + 1) * block; ++y)
        for (int x = block_x * block; x < (block_x + 1) * block; ++x)
            sum += frame.rgba[4 * (std::size_t(y) * frame.width + x) + c];
    return sum / (block * block);
}

MeanRadianceError error_of(const Frame& found, const Frame& ground_truth, const PathStatistics& sureness, int block) {
    Sums sums;
    double all = 0;
    for (int y = 0; y < ground_truth.height / block; ++y)
        for (int x = 0; x < ground_truth.width / block; ++x, ++all) {
            if (block_mean(ground_truth, x, y, 3, block) == 0) continue;
            for (int c = 0; c < 3; ++c)
                sums.add(block_mean(found, x, y, c, block), block_mean(ground_truth, x, y, c, block), 0);
        }
    // Noise is told over all pixels; those that see nothing have none.
    sums.noise = 3 * all * sureness.noise * sureness.noise / (block * block);
    return sums.over_mean();
}

std::vector<Rgb> light_between(const TransportNodes& nodes, const std::vector<Vec3>& points, bool in_medium) {
    std::vector<Rgb> light;
    for (const Vec3& p : points) light.push_back(light_at(nodes, p, in_medium));
    return light;
}

TransportErrorMetric::TransportErrorMetric(const ScatteringSubject& subject, ScatteringCase which, const Effort& effort,
                                           Progress& progress)
    : subject_(subject),
      which_(std::move(which)),
      progress_(progress),
      points_(measured_points(subject, effort.air, effort.matter)) {
    const GroundTruthCache keeper;
    air_ = keeper.mean_radiance(subject, which_, "air", points_.air, effort.paths, progress);
    matter_ = keeper.mean_radiance(subject, which_, "matter", points_.matter, effort.paths, progress);
    image_ = keeper.image(subject, which_, effort.paths_a_pixel, progress);
}

TransportNodes TransportErrorMetric::nodes(int grid, std::optional<int> iterations) const {
    IlluminationSettings settings = which_.settings(Method::transport);
    settings.transport.grid = grid;
    TransportSolver solver(subject_.device, subject_.medium.data(), which_.lighting(), settings.transport,
                           settings.scattering, {0, 0, 1}, progress_);
    while ((!iterations || solver.iterations() < *iterations) && solver.iterate(progress_)) {
    }
    return solver.nodes();
}

MeanRadianceError TransportErrorMetric::in_air(const TransportNodes& nodes) const {
    return error_of(light_between(nodes, points_.air, false), air_);
}

MeanRadianceError TransportErrorMetric::in_medium(const TransportNodes& nodes) const {
    return error_of(light_between(nodes, points_.matter, true), matter_);
}

Rgb TransportErrorMetric::light_along(const ShownLight& shown, Vec3 eye, Vec3 direction) const {
    const Geometry geometry = subject_.voxels().geometry();
    const auto n = subject_.voxels().dimensions();
    const Vec3 origin = geometry.voxel_from_world(eye), step = geometry.voxel_from_world_vector(direction);
    double near = 0, far = 1e30;
    for (int a = 0; a < 3; ++a) {
        const double low = (0 - origin[a]) / step[a], high = (n[a] - 1 - origin[a]) / step[a];
        near = std::max(near, std::min(low, high)), far = std::min(far, std::max(low, high));
    }
    Rgb light{0, 0, 0};
    constexpr double opaque = 1e-4;
    const double length = geometry.smallest_spacing_mm() / 64;
    double clear = 1;
    for (double t = near + length / 2; t < far && clear > opaque; t += length) {
        const Vec3 p = origin + t * step;
        const OpticalTable::Entry& entry = entry_at(subject_.medium, p);
        if (entry.extinction_per_mm == 0) continue;
        const double passed = std::exp(-length * entry.extinction_per_mm), share = clear * (1 - passed);
        const double most = std::max({entry.r, entry.g, entry.b});
        const double cap = most > which_.albedo ? which_.albedo / most : 1;
        const Rgb j = shown_at(shown, p, entry.extinction_per_mm * geometry.smallest_spacing_mm());
        light[0] += share * cap * entry.r * j[0], light[1] += share * cap * entry.g * j[1];
        light[2] += share * cap * entry.b * j[2], clear *= passed;
    }
    return light;
}

Frame TransportErrorMetric::image(const TransportNodes& nodes) const {
    const Scene& scene = subject_.scene;
    const Camera camera = make_camera(scene.camera, subject_.voxels().geometry(), subject_.voxels().dimensions());
    Frame frame(scene.width, scene.height);
    const Geometry geometry = subject_.voxels().geometry();
    // What falls on a surface in the open: no more than the brightest light there is.
    std::array<float, 3> most{};
    for (std::size_t i = 0; i < nodes.light.size(); ++i) most[i % 3] = std::max(most[i % 3], nodes.light[i]);
    const TransportLight light(subject_.device, nodes, nodes.grid.edge_mm / geometry.smallest_spacing_mm(), most);
    const auto shown = light.shown(Look::particles, geometry.voxel_from_world(camera.eye));
    parallel_for(subject_.device.threads, scene.height, 1, [&](std::int64_t y, std::int64_t) {
        for (int x = 0; x < scene.width; ++x) {
            const double across = ((x + 0.5) / scene.width * 2 - 1) * camera.half_height * scene.width / scene.height,
                         up = (1 - (double(y) + 0.5) / scene.height * 2) * camera.half_height;
            const Vec3 direction = normalized(camera.forward + across * camera.right + up * camera.up);
            const Rgb seen = light_along(*shown, camera.eye, direction);
            for (std::size_t c = 0; c < 3; ++c) frame.rgba[4 * (std::size_t(y) * scene.width + x) + c] = float(seen[c]);
        }
    });
    return frame;
}

MeanRadianceError TransportErrorMetric::of_image(const Frame& frame, int block) const {
    return error_of(frame, image_.first, image_.second, block);
}

}  // namespace chiaro::bench
