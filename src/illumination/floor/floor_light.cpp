#include "illumination/floor/floor_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/threads.h"
#include "illumination/floor/launch.h"
#include "illumination/floor/scattered.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int max_nodes = 128;            // along the longest side
constexpr int bins_x = 256, bins_y = 64;  // of the upper half of the sphere

/// What a bin of the sky sends on a floor: ∫ L cos θ dω.
using BinLight = std::array<double, 3>;

struct Sky {
    std::vector<BinLight> bins = std::vector<BinLight>(std::size_t(bins_x) * bins_y);
    BinLight all{};
};

Sky sky_of(const ProbeImage& image) {
    Sky sky;
    const int across = std::max(1, (image.width + bins_x - 1) / bins_x),
              down = std::max(1, (image.height / 2 + bins_y - 1) / bins_y);
    const auto cosine = [](double share) { return std::cos(0.5 * pi * share); };
    for (int j = 0; j < bins_y * down; ++j) {
        const double top = cosine(double(j) / (bins_y * down)), bottom = cosine(double(j + 1) / (bins_y * down));
        const double weight = pi / (bins_x * across) * (top * top - bottom * bottom);  // ∫ cos θ dω
        const int row = std::min(int((j + 0.5) / (2 * bins_y * down) * image.height), image.height - 1);
        for (int i = 0; i < bins_x * across; ++i) {
            const int column = std::min(int((i + 0.5) / (bins_x * across) * image.width), image.width - 1);
            const float* rgb = &image.rgb[3 * (std::size_t(row) * image.width + column)];
            for (int c = 0; c < 3; ++c) {
                sky.bins[std::size_t(j / down) * bins_x + i / across][c] += weight * rgb[c];
                sky.all[c] += weight * rgb[c];
            }
        }
    }
    return sky;
}

double luminance(const BinLight& light) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += luminance_weights[c] * light[c];
    return sum;
}

/// Bin number n along Hilbert's curve (1891) through four squares side by side: bins near in number are near in the
/// sky.
std::array<int, 2> bin_at(int n) {
    static_assert(bins_x == 4 * bins_y);
    int x = 0, y = 0;
    for (int size = 1, left = n % (bins_y * bins_y); size < bins_y; size *= 2, left /= 4) {
        const int right = left / 2 & 1, up = (left ^ right) & 1;
        if (!up) {
            if (right) x = size - 1 - x, y = size - 1 - y;
            std::swap(x, y);
        }
        x += size * right, y += size * up;
    }
    return {x + n / (bins_y * bins_y) * bins_y, y};
}

/// Directions (probe's frame) drawn in proportion to their light's luminance, each with its share of E/π: numbers
/// spread evenly over the bins' sums along the curve.
struct Drawn {
    std::vector<Vec3> directions;
    std::vector<BinLight> light;
};
Drawn draw_directions(const Sky& sky, int rays) {
    Drawn drawn;
    const double total = luminance(sky.all);
    if (!(total > 0)) return drawn;
    double before = 0;
    BinLight sum{};
    int k = 0;
    for (int n = 0; n < bins_x * bins_y; ++n) {
        const auto [i, j] = bin_at(n);
        const BinLight& bin = sky.bins[std::size_t(j) * bins_x + i];
        const double share = luminance(bin) / total;
        for (; k < rays && (k + 0.5) / rays < before + share; ++k) {
            // Within the bin by an additive recurrence (Roberts 2018).
            const double u = std::fmod(0.5 + 0.7548776662 * (k + 1), 1), v = std::fmod(0.5 + 0.5698402910 * (k + 1), 1);
            const double polar = 0.5 * pi * (j + v) / bins_y, azimuth = 2 * pi * (0.5 - (i + u) / bins_x);
            drawn.directions.push_back(
                {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)});
            drawn.light.push_back(bin);
            for (int c = 0; c < 3; ++c) sum[c] += drawn.light.back()[c] /= luminance(bin);
        }
        before += share;
    }
    for (BinLight& light : drawn.light)
        for (int c = 0; c < 3; ++c) light[c] *= sum[c] > 0 ? sky.all[c] / pi / sum[c] : 0;
    return drawn;
}

std::shared_ptr<const Density> density_of(const Device& device, const Medium::Data& medium, Progress& progress) {
    const auto cells = make_cell_grid(medium.volume.dimensions(), medium.volume.geometry()).count;
    int subsample = 1;
    while (subsample < 8 && *std::max_element(cells.begin(), cells.end()) > max_nodes * subsample) subsample *= 2;
    Density density = density_for(medium, subsample, device, progress);
    while (*std::max_element(density.grid.count.begin(), density.grid.count.end()) > max_nodes)
        density = halved(density, device, progress);
    return std::make_shared<const Density>(std::move(density));
}

/// The box of voxels around all nodes that hold something, and half a node more; empty where none does.
std::pair<kernel::Float3, kernel::Float3> box_of(const Density& density) {
    const auto& n = density.grid.count;
    std::array<int, 3> low = n, high{-1, -1, -1};
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) {
                if (!(density.data()[density.grid.index(x, y, z)] > 0)) continue;
                const int at[3] = {x, y, z};
                for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
            }
    const auto corner = [&](const std::array<int, 3>& at, double off) {
        return float3(density.grid.voxel_of(at[0] + off, at[1] + off, at[2] + off));
    };
    return {corner(low, -1), corner(high, 1)};
}

/// The map's points, and the light on them.
void shine_on(LitFloor& lit, const Device& device, const Floor& floor, const Density& density, const Lighting& lighting,
              const Geometry& geometry, const FloorQuestion& question, Progress& progress) {
    const bool by_probe = question.shadow == FloorShadow::probe;
    const int map_edge = question.quality.edge;
    const Probe probe = by_probe ? lighting_probe(lighting) : builtin_probe("white");
    const double gain = by_probe ? probe_gain(lighting) : 1;
    const Axes world = world_from_probe(by_probe ? lighting.probe.rotation_deg : 0, floor.up);
    const Drawn drawn = draw_directions(sky_of(probe.data().image), question.quality.rays);
    std::vector<kernel::FloorRay> of(drawn.directions.size());
    for (std::size_t k = 0; k < of.size(); ++k) {
        of[k].direction = float3(geometry.voxel_from_world_vector(turned(world, drawn.directions[k])));
        for (int c = 0; c < 3; ++c) of[k].light[c] = float(gain * drawn.light[k][c]);
    }

    const std::size_t points = std::size_t(map_edge) * map_edge;
    std::vector<float> places(3 * points);
    for (int j = 0; j < map_edge; ++j)
        for (int i = 0; i < map_edge; ++i) {
            const auto along = [=](int n) { return kernel::FloorView::end * (2.0 * n / (map_edge - 1) - 1); };
            const Vec3 p = geometry.voxel_from_world(floor.point(along(i), along(j)));
            for (int a = 0; a < 3; ++a) places[a * points + std::size_t(j) * map_edge + i] = float(p[a]);
        }
    std::vector<float> depth(density.data(), density.data() + density.grid.size());
    depth.push_back(0);
    const auto [low, high] = box_of(density);
    const kernel::FloorLightKernel kernel{.depth = depth.data(),
                                          .grid = view_of(density.grid),
                                          .low = low,
                                          .high = high,
                                          .rays = of.data(),
                                          .ray_count = int(of.size()),
                                          .step_mm = float(density.grid.edge_mm),
                                          .per_step = 1,
                                          .strength = float(lighting.strength)};
    lit.edge = map_edge;
    lit.light.resize(3 * points);
    const kernel::FloorPoints at{
        &places[0], &places[points], &places[2 * points], {&lit.light[0], &lit.light[points], &lit.light[2 * points]}};
    const auto run = kernel::light_floor_for(device.isa);
    parallel_for(device.threads, map_edge, 1, "floor", progress,
                 [&](std::int64_t row, std::int64_t) { run(kernel, at, row * map_edge, (row + 1) * map_edge); });
    progress.check();
}

}  // namespace

std::shared_ptr<const LitFloor> FloorLight::light(const Device& device, const Medium::Data& medium,
                                                  const Lighting& lighting, Vec3 up, const FloorQuestion& question,
                                                  Progress& progress) const {
    const Inputs inputs{
        lighting.loaded_probe, lighting.probe.rotation_deg, exposure_stops(lighting), lighting.strength, up, question};
    const std::lock_guard lock(mutex_);
    if (of_ == inputs) return kept_;
    if (!floor_ || floor_->first != up) floor_.emplace(up, find_floor(medium, up));
    std::shared_ptr<LitFloor> lit;
    if (const auto& floor = floor_->second) {
        const Geometry& geometry = medium.volume.geometry();
        lit = std::make_shared<LitFloor>();
        lit->view = view_of(*floor, geometry);
        if (question.shadow != FloorShadow::none) {
            if (!density_) density_ = density_of(device, medium, progress);
            shine_on(*lit, device, *floor, *density_, lighting, geometry, question, progress);
        }
        if (question.scattered)
            add_scattered(*lit, *question.scattered, *floor, geometry, lighting.strength * probe_gain(lighting),
                          device.threads);
    }
    kept_ = std::move(lit);
    of_ = inputs;
    return kept_;
}

}  // namespace chiaro
