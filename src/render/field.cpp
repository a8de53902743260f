#include <chiaro/describe.h>
#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "classify/medium.h"
#include "illumination/access.h"
#include "illumination/reference/visibility.h"
#include "illumination/sh/volume.h"
#include "illumination/transport/transport.h"
#include "illumination/visibility/visibility.h"

namespace chiaro {
namespace {

void check_computable(const Shape& shape, const IlluminationSettings& settings) {
    if (settings.method == Method::none)
        throw Error(ErrorCode::usage, "lighting method none computes no field: choose another, such as spao");
    if (!is_lit(shape.mode))
        throw Error(ErrorCode::usage,
                    "a value of a whole ray has no place that could be lit: fields go with dvr and iso");
    if (settings.method == Method::reference && settings.reference.quantity == ReferenceQuantity::radiance)
        throw Error(ErrorCode::usage,
                    "the reference's quantity radiance is a picture, no field: write it with chiaro render, or choose "
                    "obscurance, ao, ao-cosine, visibility or mean-radiance");
}

/// "chiaro_spao_levels" of the flag "spao-levels".
std::string key_of(const Setting& setting) {
    std::string key = fmt::format("chiaro_{}", setting.name);
    std::replace(key.begin(), key.end(), '-', '_');
    return key;
}

/// Whether the answer is V in spherical harmonics rather than a share of light.
bool is_in_harmonics(const IlluminationSettings& settings) {
    if (settings.method == Method::visibility) return true;
    return settings.method == Method::reference && settings.reference.quantity == ReferenceQuantity::visibility;
}

Volume harmonics_of(const Device& device, const Medium& medium, const IlluminationSettings& settings, StageTimer& timer,
                    Progress& progress) {
    const auto traced = [&] {
        const CellOpacity opacity = timer("opacity", [&] { return cell_opacity(device, medium.data(), progress); });
        return reference_visibility(device, medium.data(), opacity, settings.reference, timer, progress);
    };
    const auto found = [&] {
        const Density density = timer(
            "density", [&] { return density_for(medium.data(), settings.visibility.subsample, device, progress); });
        return find_visibility(device, density, settings.visibility, timer, progress);
    };
    const ShField field = settings.method == Method::visibility ? found() : traced();
    return timer("voxels", [&] { return volume_of(device, field, medium.data().volume, progress); });
}

/// Mean radiance at the nodes of the light grid.
Volume swept_light(const Device& device, const Medium& medium, const Lighting& lighting,
                   const IlluminationSettings& settings, StageTimer& timer, Progress& progress) {
    std::optional<TransportNodes> found;
    const auto keep = [&](TransportNodes nodes, bool) { found = std::move(nodes); };
    refine_transport(device, medium.data(), lighting, settings.transport, settings.scattering, surface_model(settings),
                     lighting.probe_up.value_or(Vec3{0, 0, 1}), keep, timer, progress);
    Volume out = make_volume(found->grid.count, VoxelType::f32);
    out.geometry = geometry_of(found->grid, medium.data().volume.geometry());
    out.components = 3;
    out.voxels = VoxelBuffer(found->light.size() * sizeof(float));
    std::copy(found->light.begin(), found->light.end(), out.as<float>().begin());
    return out;
}

bool is_mean_radiance(const IlluminationSettings& settings) {
    return settings.method == Method::reference && settings.reference.quantity == ReferenceQuantity::mean_radiance;
}

/// Points at the centres of blocks of `edge`³ voxels, as a volume without voxels yet.
Volume block_centres(const DeviceVolume& voxels, int edge, int components) {
    std::array<int, 3> counts = voxels.dimensions();
    for (int& n : counts) n = (n + edge - 1) / edge;
    Volume volume = make_volume(counts, VoxelType::f32);
    volume.components = components;
    volume.voxels = VoxelBuffer(volume.voxel_count() * std::size_t(components) * sizeof(float));
    const double first = (edge - 1) / 2.0;
    volume.geometry = voxels.geometry();
    volume.geometry.origin_mm = voxels.geometry().world_from_voxel({first, first, first});
    for (double* spacing :
         {&volume.geometry.spacing_mm.x, &volume.geometry.spacing_mm.y, &volume.geometry.spacing_mm.z})
        *spacing *= edge;
    return volume;
}

/// J at every voxel, or at the centres of blocks of them.
Volume mean_radiance_of(const Device& device, const Medium& medium, const Lighting& lighting,
                        const IlluminationSettings& settings, StageTimer& timer, Progress& progress) {
    const DeviceVolume& voxels = medium.data().volume;
    const int edge = settings.reference.subsample;
    Volume field = block_centres(voxels, edge, 3);
    std::vector<Vec3> points;
    points.reserve(field.voxel_count());
    const auto centre = [&](int block) { return edge * (block + 0.5) - 0.5; };
    for (int k = 0; k < field.dimensions[2]; ++k)
        for (int j = 0; j < field.dimensions[1]; ++j)
            for (int i = 0; i < field.dimensions[0]; ++i) points.push_back({centre(i), centre(j), centre(k)});
    const MeanRadiance mean_radiance = timer("paths", [&] {
        return trace_mean_radiance(device, medium, lighting, lighting.probe_up.value_or(Vec3{0, 0, 1}), points,
                                   settings, progress);
    });
    progress.check();
    float* to = field.as<float>().data();
    for (const Rgb& j : mean_radiance.mean)
        for (const double channel : j) *to++ = float(channel);
    return field;
}

/// What a field's numbers are.
std::string quantity_of(const IlluminationSettings& settings) {
    if (is_in_harmonics(settings)) return "visibility";
    if (settings.method == Method::transport || is_mean_radiance(settings)) return "fluence";
    if (settings.method != Method::histogram) return "accessibility";
    return settings.histogram.effects.bleeding ? "environment colour" : "environment occlusion";
}

std::map<std::string, std::string> how_made(const IlluminationSettings& settings, double seconds) {
    std::map<std::string, std::string> told{{"chiaro", CHIARO_VERSION},
                                            {"chiaro_field", quantity_of(settings)},
                                            {"chiaro_lighting", to_text(settings.method)},
                                            {"chiaro_seconds", fmt::format("{:.6f}", seconds)}};
    const auto tell = [&](const Setting& setting, const auto&... fields) {
        const std::string value = value_text(setting, fields...);
        if (setting.belongs_to(to_text(settings.method)) && !value.empty()) told[key_of(setting)] = value;
    };
    describe(tell, settings.spao);
    describe(tell, settings.visibility);
    describe(tell, settings.histogram);
    describe(tell, settings.transport);
    describe(tell, settings.reference);
    describe(tell, settings.scattering);
    if (is_in_harmonics(settings)) told["chiaro_sh_axes"] = "grid";
    return told;
}

}  // namespace

ComputedField compute_field(const Device& given, const Medium& medium, const Prepared& prepared,
                            const Lighting& lighting, const IlluminationSettings& wanted, Progress& progress) {
    check_computable(medium.data().shape, wanted);
    const Device device = device_for(given, medium.data());
    IlluminationSettings settings = wanted;
    if (!settings.reference.quantity) settings.reference.quantity = ReferenceQuantity::obscurance;
    const auto start = std::chrono::steady_clock::now();
    StageTimer timer;
    const auto found = [&] {
        if (settings.method == Method::transport)
            return swept_light(device, medium, lighting, settings, timer, progress);
        if (is_mean_radiance(settings)) return mean_radiance_of(device, medium, lighting, settings, timer, progress);
        if (is_in_harmonics(settings)) return harmonics_of(device, medium, settings, timer, progress);
        return field_of_voxels(device, medium.data(), prepared, settings, timer, progress);
    };
    ComputedField field{found(), {}};
    field.volume.key_values =
        how_made(settings, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    field.stages = timer.take();
    return field;
}

}  // namespace chiaro
