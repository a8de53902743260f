#include "raycast/views.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "classify/albedo.h"
#include "classify/clip.h"
#include "classify/mixture.h"
#include "core/srgb.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

/// The light's direction: along the camera's axis, or fixed to the world in the orbit's angles.
Vec3 direction_to_light(const Light& light, const Camera& camera) {
    if (light.headlight) return -camera.forward;
    return orbit_direction(radians(light.azimuth_deg), radians(light.elevation_deg), camera.orbit_up);
}

/// Blinn's; the viewer is directional too: along the camera's axis.
Vec3 half_vector(Vec3 to_light, const Camera& camera) {
    const Vec3 sum = to_light - camera.forward;
    return length(sum) > 1e-9 ? normalized(sum) : to_light;
}

/// How far before its own block a rank begins to march, so that its rays have met the surfaces that the whole one has:
/// one follows upon the other, along a wall for as long as that is. As far as ghosts reach, but for what gradients
/// take.
double run_in_voxels(const DeviceVolume::Data& volume) {
    constexpr int of_gradients = 2;
    const Placement& place = *volume.placement;
    int ghosts = std::numeric_limits<int>::max();
    for (std::size_t a = 0; a < 3; ++a) {
        const int held = volume.held.first[a], end = held + volume.held.size[a];
        if (held > 0) ghosts = std::min(ghosts, place.own_first[a] - held);
        if (end < volume.dimensions[a]) ghosts = std::min(ghosts, end - place.own_end[a]);
    }
    const int longest = *std::max_element(volume.dimensions.begin(), volume.dimensions.end());
    return std::clamp(ghosts - of_gradients, 0, 2 * longest);
}

}  // namespace

double half_width(const Camera& camera, int width, int height) {
    return camera.half_width > 0 ? camera.half_width : camera.half_height * width / height;
}

kernel::CameraView camera_view(const Camera& camera, const Geometry& geometry, int width, int height) {
    const auto per_mm = [&](Vec3 world) { return float3(geometry.voxel_from_world_vector(world)); };
    return {
        .eye = float3(geometry.voxel_from_world(camera.eye)),
        .forward = per_mm(camera.forward),
        .right = per_mm(camera.right),
        .up = per_mm(camera.up),
        .half_width = float(half_width(camera, width, height)),
        .half_height = float(camera.half_height),
        .centre_x = float(camera.centre_x),
        .centre_y = float(camera.centre_y),
        .width = float(width),
        .height = float(height),
        .orthographic = camera.projection == Projection::orthographic,
        .lens_mm = float(camera.aperture_mm / 2),
        .focus_mm = float(camera.focus_mm),
    };
}

namespace {

/// Of a light the factors of the reflection model; what is off has none.
kernel::LightView light_view(const Light& light, const Lighting& lighting, const Camera& camera,
                             const Geometry& geometry, ColorMode color) {
    const auto times_color = [&](double factor) {
        Vec3 rgb;
        for (int c = 0; c < 3; ++c)
            rgb[c] = factor * (color == ColorMode::linear ? linear_from_srgb(light.color[c]) : light.color[c]);
        return float3(rgb);
    };
    const bool on = lighting.shading != Shading::none;
    const double kd = on ? lighting.diffuse : 0, ks = lighting.shading == Shading::phong ? lighting.specular : 0;
    if (light.position_mm)
        return {times_color(kd), times_color(ks), float3(*light.position_mm - geometry.origin_mm), {}, 1};
    const Vec3 to_light = direction_to_light(light, camera);
    return {times_color(kd), times_color(ks), float3(to_light), float3(half_vector(to_light, camera)), 0};
}

/// The first light that comes from one direction is the view's own; none: a headlight without light.
void set_lights(const Lighting& lighting, const Camera& camera, const Geometry& geometry, ColorMode color,
                kernel::ShadingView& shading) {
    bool has_own = false;
    const auto set_own = [&](const kernel::LightView& own) {
        shading.diffuse = own.diffuse, shading.specular = own.specular;
        shading.to_light = own.to_light, shading.half = own.half;
    };
    set_own(light_view(Light{.color = {0, 0, 0}}, lighting, camera, geometry, color));
    for (const Light& light : lighting.lights) {
        const kernel::LightView view = light_view(light, lighting, camera, geometry, color);
        if (!has_own && !light.position_mm)
            set_own(view), has_own = true;
        else if (shading.others < max_lights)
            shading.other[shading.others++] = view;
    }
    if (lighting.shading == Shading::none) shading.others = 0;
}

}  // namespace

kernel::ShadingView shading_view(const Lighting& lighting, const Camera& camera, const DeviceVolume::Data& volume,
                                 ColorMode color) {
    const Geometry& geometry = volume.geometry;
    const bool on = lighting.shading != Shading::none;
    // A gradient is a covector: ∇_world f = M⁻ᵀ ∇_voxel f, and the columns of M⁻¹ are the voxel vectors of the world's
    // axes.
    const Vec3 x = geometry.voxel_from_world_vector({1, 0, 0}), y = geometry.voxel_from_world_vector({0, 1, 0}),
               z = geometry.voxel_from_world_vector({0, 0, 1});
    const auto row = [&](int axis) {
        Vec3 of;
        for (int a = 0; a < 3; ++a) of[a] = geometry.direction[std::size_t(a)][axis] * geometry.spacing_mm[a];
        return float3(of);
    };
    // Only the direction counts: scaled to millimetres of the smallest edge, so that tiny or huge spacings stay in
    // float's range.
    const double edge = geometry.smallest_spacing_mm();
    kernel::ShadingView shading{};
    shading.enabled = on;
    shading.ambient = on ? float(lighting.ambient) : 1.0f;
    shading.shininess = float(lighting.shininess);
    shading.out = volume.scale < 0 && !volume.mixture ? 1.0f : -1.0f;  // extinction grows inwards
    shading.gradient_x = float3(edge * x), shading.gradient_y = float3(edge * y), shading.gradient_z = float3(edge * z);
    shading.world_x = row(0), shading.world_y = row(1), shading.world_z = row(2);
    shading.to_eye = float3(-camera.forward);
    set_lights(lighting, camera, geometry, color, shading);
    return shading;
}

void shine_from(const MainLight& light, const Lighting& lighting, const Camera& camera, kernel::ShadingView& shading) {
    const double ks = lighting.shading == Shading::phong ? lighting.specular * light.share : 0;
    shading.others = 0;
    shading.specular = float3({ks, ks, ks});
    shading.to_light = float3(light.direction);
    shading.half = float3(half_vector(light.direction, camera));
}

kernel::ClipView clip_view(const Clip& clip, const Geometry& geometry, const std::array<int, 3>& dimensions) {
    kernel::ClipView view{};
    for (const HalfSpace& kept : half_spaces(clip, geometry, dimensions))
        view.planes[view.count++] = {float3(kept.normal), float(kept.d)};
    return view;
}

kernel::SolidView solid_view(double step_voxels) {
    const double from = -std::expm1(-0.5 * step_voxels), to = -std::expm1(-1.5 * step_voxels);
    return {float(from), float(1 / std::max(to - from, 1e-6))};
}

kernel::SurfacesView surfaces_view(const Medium::Data& medium, bool backwards, std::optional<double> albedo_limit) {
    const DeviceVolume::Data& volume = medium.volume.data();
    std::vector<IsoSurface> surfaces = medium.shape.iso;
    const auto stored = [&](const IsoSurface& s) { return (s.value - volume.offset) / volume.scale; };
    std::sort(surfaces.begin(), surfaces.end(), [&](const auto& a, const auto& b) { return stored(a) < stored(b); });
    kernel::SurfacesView view{};
    view.backwards = backwards;
    view.outside = volume.scale > 0 ? -3e38f : 3e38f;
    if (medium.surface_labels) albedo_limit.reset();  // of what they are tinted
    for (const IsoSurface& s : surfaces) {
        const OpticalTable::Entry& entry = medium.table.at(stored(s));
        std::array<float, 3> rgb{entry.r, entry.g, entry.b};
        if (s.color)
            for (int c = 0; c < 3; ++c)
                rgb[c] =
                    float(medium.shape.color == ColorMode::linear ? linear_from_srgb((*s.color)[c]) : (*s.color)[c]);
        const float alpha = float(s.opacity), factor = alpha * albedo_factor(rgb[0], rgb[1], rgb[2], albedo_limit);
        view.values[view.count] = float(stored(s));
        view.colours[view.count++] = {factor * rgb[0], factor * rgb[1], factor * rgb[2], alpha};
    }
    return view;
}

double step_mm(double step_voxels, const Geometry& geometry, const std::array<int, 3>& n) {
    constexpr double max_steps = 1 << 23;
    double longest_mm = 0;  // the box has no longer diagonal
    for (int axis = 0; axis < 3; ++axis) longest_mm += n[axis] * geometry.spacing_mm[axis];
    return std::max(step_voxels * geometry.smallest_spacing_mm(), longest_mm / max_steps);
}

namespace {

template <class Alpha>
std::vector<kernel::Rgba> table_of(const OpticalTable& table, Alpha&& alpha_of) {
    std::vector<kernel::Rgba> steps;
    steps.reserve(table.entries.size());
    for (const auto& e : table.entries) {
        const float alpha = float(alpha_of(double(e.extinction_per_mm)));
        steps.push_back({e.r * alpha, e.g * alpha, e.b * alpha, alpha});
    }
    return steps;
}

}  // namespace

std::vector<kernel::Rgba> step_table(const OpticalTable& table, double step_mm) {
    return table_of(table, [=](double extinction_per_mm) { return -std::expm1(-extinction_per_mm * step_mm); });
}

std::vector<kernel::Rgba> emission_table(const OpticalTable& table, double step_mm) {
    return table_of(table, [=](double extinction_per_mm) { return extinction_per_mm * step_mm; });
}

std::vector<float> onset_table(const std::vector<kernel::Rgba>& steps) {
    const auto change = [](const kernel::Rgba& a, const kernel::Rgba& b) {
        return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
    };
    std::vector<float> onsets(steps.size(), std::numeric_limits<float>::max());
    const auto count_from = [&](auto step, auto end, auto onset) {
        kernel::Rgba before{0, 0, 0, 0};
        for (float since = 0; step != end; before = *step++) {
            since = step->a > 0 ? since + change(before, *step) : 0;
            *onset = std::min(*onset, since), ++onset;
        }
    };
    count_from(steps.begin(), steps.end(), onsets.begin());
    count_from(steps.rbegin(), steps.rend(), onsets.rbegin());
    return onsets;
}

void check_ends(const RaySettings& settings, const Frame& frame) {
    if (!settings.ends) return;
    const RayEnds& ends = *settings.ends;
    if (ends.width != frame.width || ends.height != frame.height ||
        ends.mm.size() != std::size_t(frame.width) * frame.height)
        throw Error(ErrorCode::usage, "the depths at which rays end are those of a picture of another size");
}

kernel::March march_of(Mode mode) {
    if (mode == Mode::iso) return kernel::March::surfaces;
    if (mode == Mode::mip || mode == Mode::minip) return kernel::March::extreme;
    return mode == Mode::mean ? kernel::March::mean : kernel::March::volume;
}

kernel::MarchOptions march_options(const RaySettings& settings, const Medium::Data& medium) {
    const Mode mode = medium.shape.mode;
    bool any_by_gradient = false;
    for_each_channel(medium, [&](const Medium::Data& channel) {
        any_by_gradient = any_by_gradient || channel.volume.data().factor != nullptr;
    });
    const bool by_values = march_of(mode) != kernel::March::volume;
    if (is_mixed(medium) && !by_values && settings.classification == Classification::preintegrated)
        throw Error(ErrorCode::usage,
                    "--classification preintegrated: a step by the values at its ends is of one channel; several go "
                    "with post and pre");
    const bool labelled = is_labelled_channel(medium) &&
                          (by_values || (!any_by_gradient && (settings.classification == Classification::post ||
                                                              !medium.volume.data().mixture->labels->cuts())));
    if (any_by_gradient && settings.classification != Classification::post)
        throw Error(ErrorCode::usage,
                    "--classification: opacity by gradient, and over value and gradient, goes with post: a step by the "
                    "values at its ends, or a voxel alone, has no gradient");
    const bool additive = mode == Mode::additive;
    return {.classification = additive ? kernel::Classification::post : kernel::Classification(settings.classification),
            .backwards = !additive && settings.compositing == Compositing::back_to_front,
            .additive = additive,
            .by_gradient = medium.volume.data().factor != nullptr,
            .mixed = is_mixed(medium) && !labelled,
            .labelled = labelled,
            .by_block = medium.volume.data().placement.has_value()};
}

kernel::OwnBox own_box(const Medium::Data& medium, double step_voxels) {
    const DeviceVolume::Data& volume = medium.volume.data();
    if (!volume.placement) return {};
    constexpr float beyond = 1e6f;
    const Placement& place = *volume.placement;
    const int before = is_lit(medium.shape.mode) ? int(run_in_voxels(volume) / step_voxels) : 0;
    kernel::OwnBox box{.low = {}, .high = {}, .before = before, .on = 1};
    const auto low = [&](std::size_t a) { return place.own_first[a] > 0 ? float(place.own_first[a]) : -beyond; };
    const auto high = [&](std::size_t a) {
        return place.own_end[a] < place.whole[a] ? float(place.own_end[a]) : beyond;
    };
    if (!place.owns_any()) return {.low = {0, 0, 0}, .high = {0, 0, 0}, .before = 0, .on = 1};
    box.low = {low(0), low(1), low(2)}, box.high = {high(0), high(1), high(2)};
    return box;
}

kernel::ExtremeView extreme_view(const DeviceVolume::Data& volume, Mode mode) {
    const bool is_largest = (mode == Mode::mip) == (volume.scale > 0);  // of stored values
    // Splines go beyond the values that they pass through.
    constexpr float none = std::numeric_limits<float>::max();
    const bool is_spline = volume.coefficients.size() > 0;
    if (is_largest) return {volume.cells.high.data(), is_spline ? none : volume.stored_max, 1};
    return {volume.cells.low.data(), is_spline ? -none : volume.stored_min, -1};
}

namespace {

/// Whether lit rays are refined: not in drafts, which are linear.
bool refines(const Medium::Data& medium) {
    bool any_spline = false;
    for_each_channel(medium, [&](const Medium::Data& channel) {
        any_spline = any_spline || channel.volume.data().coefficients.size() > 0;
    });
    return any_spline;
}

}  // namespace

RayTables make_tables(const Medium::Data& medium, const RaySettings& settings, int threads, const LitField* lit) {
    // Where nothing is integrated a value shows as one reference length of it.
    const DeviceVolume::Data& volume = medium.volume.data();
    const double step_mm = chiaro::step_mm(settings.step_voxels, volume.geometry, volume.dimensions);
    const Mode mode = medium.shape.mode;
    const std::optional<double> albedo_limit = lit ? lit->albedo_limit : std::nullopt;
    // Colours of samples that labels tint are limited after that.
    const OpticalTable table = is_labelled_channel(medium) ? medium.table : with_albedos(medium.table, albedo_limit);
    const bool integrated = is_lit(mode) || mode == Mode::additive;
    RayTables tables{mode == Mode::additive ? emission_table(table, step_mm)
                                            : step_table(table, integrated ? step_mm : table.unit_mm),
                     {},
                     {},
                     {},
                     {}};
    if (lit && mode == Mode::dvr && refines(medium)) tables.onsets = onset_table(tables.steps);
    if (lit && mode == Mode::dvr) {
        if (lit->by_surface()) tables.surface = surface_table_of(medium);
        if (lit->by_share_table()) tables.shares = share_table_of(medium);
    }
    if (mode == Mode::dvr && settings.classification == Classification::preintegrated && !is_mixed(medium))
        tables.segments = segment_table(medium, step_mm, albedo_limit, threads);
    return tables;
}

kernel::StepTableView step_table_view(const OpticalTable& table, const RayTables& tables) {
    return {{tables.steps.data(), float(table.index_scale), float(table.index_offset + 0.5),
             float(tables.steps.size() - 1)}};
}

kernel::SegmentTableView segment_table_view(const SegmentTable* table) {
    if (!table) return {};
    return {table->entries.data(), table->visible_before.data(), float(table->scale), float(table->offset),
            table->nodes};
}

}  // namespace chiaro
