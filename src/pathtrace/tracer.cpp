#include "pathtrace/tracer.h"

#include <chiaro/error.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "classify/albedo.h"
#include "core/threads.h"
#include "illumination/probe/data.h"
#include "pathtrace/launch.h"
#include "raycast/views.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr int tile_edge = 64;                 ///< pixels; large, so that few lanes wait for the last paths
constexpr double normal_offset_edges = 0.01;  ///< more than what bisection leaves uncertain

kernel::AxesView axes_view(const Geometry& g) {
    const auto voxels = [&](Vec3 mm) { return float3(g.voxel_from_world_vector(mm)); };
    const auto mm = [&](Vec3 steps) { return float3(g.world_from_voxel_vector(steps)); };
    return {voxels({1, 0, 0}), voxels({0, 1, 0}), voxels({0, 0, 1}), mm({1, 0, 0}), mm({0, 1, 0}), mm({0, 0, 1})};
}

/// The camera looks into the box of the voxel centres (an axis of one voxel is one voxel thick), light passes whole
/// voxels.
kernel::Box box_of(std::array<int, 3> n, bool whole_voxels) {
    const auto low = [&](int i) { return n[i] == 1 || whole_voxels ? -0.5f : 0.0f; };
    const auto high = [&](int i) { return float(n[i] - 1) + (n[i] == 1 || whole_voxels ? 0.5f : 0.0f); };
    return {{low(0), low(1), low(2)}, {high(0), high(1), high(2)}};
}

/// Two words from a seed (the finaliser of SplitMix64: Steele, Lea and Flood 2014).
std::uint64_t scrambled(std::uint64_t seed) {
    seed += 0x9e3779b97f4a7c15u;
    seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
    seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
    return seed ^ (seed >> 31);
}

kernel::RegionsView regions_view(const Medium::Data& medium, const Majorants& majorants) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const OpticalTable& table = medium.table;
    const auto [nx, ny, nz] = volume.dimensions;
    const double nudge =
        1e-6 * std::max({nx, ny, nz, 64});  // what t d + o may be wrong by, some units in the last place
    return {.cells = majorants.cells.data(),
            .cells_x = cell_count(nx),
            .cells_y = cell_count(ny),
            .nudge = float(nudge),
            .nudge_mm = float(nudge * volume.geometry.smallest_spacing_mm()),
            .extinction = {majorants.runs.data(), int(table.entries.size())},
            .scale = float(table.index_scale),
            .offset = float(table.index_offset + 0.5),
            .last = float(table.entries.size() - 1),
            .beyond = float(4e-7 * table.index_scale)};
}

const float* of_points(const std::vector<float>& coordinates) {
    return coordinates.empty() ? nullptr : coordinates.data();
}

/// As a mixture's colours are.
int packed_grey(double albedo) {
    return int(std::lround(std::clamp(albedo, 0.0, 1.0) * 1023)) * ((1 << 20) + (1 << 10) + 1);
}

/// Whether colours are found where they are: those of a mixture, and of isosurfaces that labels tint.
bool has_colours_by_place(const Medium::Data& medium) {
    return is_mixed(medium) || (medium.surface_labels && medium.surface_labels->tint.size());
}

kernel::Rgba straight(const kernel::Rgba& c) {
    const float inverse = c.a > 0 ? 1 / c.a : 0;
    return {inverse * c.r, inverse * c.g, inverse * c.b, 1};
}

Medium checked(const Medium& medium, const RaySettings& settings) {
    if (!is_lit(medium.data().shape.mode))
        throw Error(ErrorCode::usage,
                    "a value of a whole ray has no place that could be lit: the reference's radiance goes with dvr and "
                    "iso");
    if (settings.ends) throw Error(ErrorCode::usage, "paths do not end at a depth: the reference goes without");
    return medium;
}

}  // namespace

/// What "unlimited" comes to: with albedo 1 a closed cavity would keep a path for ever.
constexpr int unlimited_bounces = 1'000'000;

PathOptions path_options(const IlluminationSettings& settings) {
    return {settings.scattering.bounces.most,     settings.scattering.albedo_max, settings.scattering.anisotropy,
            settings.reference.start_half_voxels, settings.scattering.seed,       shows_surfaces(settings)};
}

PathTracer::PathTracer(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                       const RaySettings& settings, const PathOptions& options, int width, int height,
                       PathPoints points)
    : device_(device),
      medium_(checked(medium, settings)),
      lighting_(lighting),
      light_(lighting_, camera.orbit_up),
      floor_(lighting.floor.show ? find_floor(medium.data(), camera.orbit_up) : std::nullopt),
      surface_table_(surface_table_of(medium_.data())),
      reflection_(lighting.shading == Shading::phong ? lighting.specular : 0, lighting.shininess),
      majorants_(options.plain ? one_majorant(medium.data()) : make_majorants(medium.data(), device.threads)),
      width_(width),
      height_(height),
      points_(std::move(points)) {
    make_colours(options);
    trace_tile_ = with_stored_voxel(medium.data().volume.data(), [&](auto voxel) {
        return tracer_through<decltype(voxel)>(camera, lighting, settings, options);
    });
    if (!gpu_) sums_.resize(std::size_t(width) * height);
}

/// One scattering shows the colour as it is. With more it is the albedo: light may come by any number of times, so it
/// stays below albedo-max.
void PathTracer::make_colours(const PathOptions& options) {
    const Medium::Data& data = medium_.data();
    const auto limit = options.bounces == 0 ? std::nullopt : std::optional(options.albedo_max);
    if (has_colours_by_place(data)) {
        floor_material_ = packed_grey(lighting_.floor.albedo);
        return;
    }
    const auto add = [&](float r, float g, float b) {
        const float factor = albedo_factor(r, g, b, limit);
        red_.push_back(factor * r), green_.push_back(factor * g), blue_.push_back(factor * b);
    };
    if (data.shape.mode == Mode::iso) {
        const kernel::SurfacesView surfaces = surfaces_view(data, false);
        for (int i = 0; i < surfaces.count; ++i) {
            const kernel::Rgba c = straight(surfaces.colours[i]);
            add(c.r, c.g, c.b);
        }
    } else {
        extinction_ = extinctions_of(data);
        for (const auto& entry : data.table.entries) add(entry.r, entry.g, entry.b);
    }
    for (auto* of_floor : {&red_, &green_, &blue_}) of_floor->push_back(float(lighting_.floor.albedo));  // the last
    floor_material_ = int(red_.size()) - 1;
}

template <class Voxel>
PathTracer::TraceTile PathTracer::tracer_through(const Camera& camera, const Lighting& lighting,
                                                 const RaySettings& settings, const PathOptions& options) {
    const Medium::Data& data = medium_.data();
    const DeviceVolume::Data& volume = data.volume.data();
    const kernel::RegionsView regions = regions_view(data, majorants_);
    const kernel::ColoursView colours{has_colours_by_place(data) ? nullptr : red_.data(), green_.data(), blue_.data()};
    const auto limit = options.bounces == 0 ? std::numeric_limits<double>::infinity() : options.albedo_max;
    if (data.shape.mode != Mode::iso) {
        const kernel::Cloud<Voxel> cloud{.volume = view_of<Voxel>(volume),
                                         .regions = regions,
                                         .extinction = extinction_.data(),
                                         .colours = colours,
                                         .scale = float(data.table.index_scale),
                                         .offset = float(data.table.index_offset + 0.5),
                                         .last = float(data.table.entries.size() - 1),
                                         .phase = {float(options.anisotropy)},
                                         .mixed = {max_extinction(volume), float(limit)}};
        if (!options.surfaces) return tracer_of(cloud, camera, settings, options);
        return tracer_of(kernel::SurfaceCloud<Voxel>{cloud, surface_table_->view(), view_of(reflection_)}, camera,
                         settings, options);
    }
    const kernel::SurfacesView view = surfaces_view(data, false);
    kernel::Surfaces<Voxel> surfaces{
        .volume = view_of<Voxel>(volume),
        .regions = regions,
        .values = {},
        .opacities = {},
        .count = view.count,
        .colours = colours,
        .gradients = shading_view(lighting, camera, volume, data.shape.color),
        .reflection = view_of(reflection_),
        .step_mm = float(step_mm(settings.step_voxels, volume.geometry, volume.dimensions)),
        .labels = label_view(data.surface_labels.get()),
        .outside = view.outside,
        .untinted = {},
        .mixed = {max_extinction(volume), float(limit)}};
    surfaces.gradients.specular = {0, 0, 0};
    std::copy_n(view.values, view.count, surfaces.values);
    for (int i = 0; i < view.count; ++i)
        surfaces.opacities[i] = view.colours[i].a, surfaces.untinted[i] = straight(view.colours[i]);
    return tracer_of(surfaces, camera, settings, options);
}

template <class Matter>
PathTracer::TraceTile PathTracer::tracer_of(const Matter& matter, const Camera& camera, const RaySettings& settings,
                                            const PathOptions& options) {
    const DeviceVolume::Data& volume = medium_.data().volume.data();
    const double edge = volume.geometry.smallest_spacing_mm();
    const std::uint64_t words = scrambled(options.seed);
    const kernel::PathKernel<Matter> kernel{
        .matter = matter,
        .start = {camera_view(camera, volume.geometry, width_, height_), of_points(points_.x), of_points(points_.y),
                  of_points(points_.z)},
        .axes = axes_view(volume.geometry),
        .seen = box_of(volume.dimensions, false),
        .lit = box_of(volume.dimensions, !Matter::has_cuts),  // or its borders are cuts
        .clip_view = clip_view(medium_.data().shape.clip, volume.geometry, volume.dimensions),
        .probe = light_.view(),
        .floor = floor_ ? view_of(*floor_, volume.geometry) : kernel::FloorView(),
        .floor_material = floor_material_,
        .max_scatterings = options.bounces.value_or(unlimited_bounces) + 1,
        .start_mm = Matter::has_cuts ? 0 : float(0.5 * edge * options.start_half_voxels),
        .normal_offset_mm = float(normal_offset_edges * edge),
        .sub_pixels = settings.samples_per_pixel,
        .pixel_key = std::int32_t(words),
        .sample_key = std::int32_t(words >> 32),
        .width = width_};
    if (!is_for_cpu(medium_.data())) cuda::try_gpu(device_, [&] { gpu_ = gpu_tracer_of(kernel); });
    return [kernel, trace = kernel::trace_tile_for<kernel::PathKernel<Matter>>(device_.isa)](
               const kernel::PathTask& task) { return trace(kernel, task); };
}

template <class Kernel>
std::unique_ptr<GpuPaths> PathTracer::gpu_tracer_of(const Kernel& kernel) const {
    HostArrays arrays;
    medium_.data().add_to(arrays);
    light_.add_to(arrays);
    const std::vector<float>* const own[] = {
        &majorants_.cells, &majorants_.runs, &extinction_, &surface_table_->opacity(), &red_, &green_, &blue_,
        &points_.x,        &points_.y,       &points_.z,   &reflection_.reflected()};
    for (const auto* numbers : own) arrays.add(*numbers);
    return std::make_unique<GpuTracer<Kernel>>(device_, kernel, arrays, width_, height_);
}

/// False where the CPU must: where the GPU gives way, it goes on from the sums that the GPU has.
template <class Work>
bool PathTracer::done_there(const Work& work) {
    if (!gpu_) return false;
    if (cuda::try_gpu(device_, work)) return true;
    sums_ = gpu_->sums(), collisions_ = gpu_->collisions(), samples_ = gpu_->samples();
    gpu_.reset();
    return false;
}

std::int64_t PathTracer::trace(const kernel::Tile& tile, int first, int end, const Progress& progress) {
    std::int64_t collisions = 0;
    std::vector<kernel::Rgba> results(std::size_t(tile.x1 - tile.x0) * (tile.y1 - tile.y0));
    for (int sample = first; sample < end && !progress.cancelled(); ++sample) {
        collisions += trace_tile_({tile, sample, results.data()});
        const kernel::Rgba* result = results.data();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x, ++result) sums_[std::size_t(y) * width_ + x].add(*result);
    }
    return collisions;
}

bool PathTracer::add(int samples, const Progress& progress) {
    const int end = samples_ + samples;
    if (!done_there([&] { gpu_->add_up_to(end, progress); })) add_here(end, progress);
    samples_ = end;
    return !progress.cancelled();
}

void PathTracer::add_here(int end, const Progress& progress) {
    const int columns = (width_ + tile_edge - 1) / tile_edge, rows = (height_ + tile_edge - 1) / tile_edge;
    std::atomic<std::int64_t> collisions{0};
    parallel_for(device_.threads, std::int64_t(columns) * rows, 1, [&](std::int64_t t, std::int64_t) {
        const int x = int(t % columns) * tile_edge, y = int(t / columns) * tile_edge;
        collisions +=
            trace({x, y, std::min(x + tile_edge, width_), std::min(y + tile_edge, height_)}, samples_, end, progress);
    });
    collisions_ += std::uint64_t(collisions);
}

void PathTracer::show(RenderTarget& target) {
    if (done_there([&] { gpu_->show(target.pixels); })) return;
    target.pixels.reset();
    const kernel::MeanKernel mean{sums_.data(), reinterpret_cast<kernel::Rgba*>(target.frame.rgba.data()),
                                  1.0 / std::max(samples_, 1)};
    for (std::int64_t i = 0; i < std::int64_t(sums_.size()); ++i) mean(i);
}

const std::vector<PixelSum>& PathTracer::sums() {
    if (gpu_) sums_ = gpu_->sums();
    return sums_;
}

PathStatistics PathTracer::statistics() {
    const double pixels = double(width_) * height_;
    std::vector<kernel::PathNoise> runs;
    if (!done_there([&] { gpu_->measure(runs); })) {
        runs.resize(std::size_t(kernel::NoiseKernel::runs(std::int64_t(pixels))));
        const kernel::NoiseKernel measure{sums_.data(), runs.data(), std::int64_t(pixels), double(samples_)};
        for (std::int64_t i = 0; i < std::int64_t(runs.size()); ++i) measure(i);
    }
    kernel::PathNoise all;
    for (const auto& run : runs) all.errors += run.errors, all.light += run.light;
    return {samples_, std::sqrt(all.errors / pixels),
            all.light > 0 ? std::sqrt(all.errors / all.light) : std::numeric_limits<double>::infinity()};
}

}  // namespace chiaro
