#include "render/appearance.h"

#include <chiaro/samples.h>

#include <algorithm>
#include <cmath>

#include "illumination/probe/lights.h"

namespace chiaro {
namespace {

TransferFunction chosen(const TransferSettings& settings, const Subject& subject) {
    if (settings.points) return *settings.points;
    if (!settings.source.empty()) return load_transfer_function(settings.source, subject.statistics);
    constexpr std::string_view prefix = "sample:";
    if (!subject.source.starts_with(prefix)) return preset(subject.guess.preset, subject.statistics);
    const std::string name = subject.source.substr(prefix.size());
    return sample_transfer_function(name.substr(0, name.find(':')));
}

}  // namespace

Subject study(const Volume& volume, const Progress& progress) {
    const Statistics statistics = measure(volume, progress);
    const bool is_told = volume.component_infos.size() == 1;
    return {volume.source, statistics, guess(volume, statistics),
            is_told ? volume.component_infos.front() : ComponentInfo()};
}

TransferFunction transfer_function_for(const TransferSettings& settings, const Subject& subject) {
    TransferFunction tf = chosen(settings, subject);
    if (settings.window) tf = with_window(std::move(tf), settings.window->first, settings.window->second);
    if (settings.opacity_unit) tf.opacity_unit = *settings.opacity_unit, tf.opacity_unit_is_mm = false;
    if (settings.opacity_unit_mm) tf.opacity_unit = *settings.opacity_unit_mm, tf.opacity_unit_is_mm = true;
    return tf;
}

namespace {
bool is_named(const TransferSettings& settings) { return settings.points || !settings.source.empty(); }
}  // namespace

TransferFunction transfer_function_of_channel(const ChannelSettings& channel, std::size_t index, std::size_t count,
                                              const TransferSettings& of_scene, const Subject& subject) {
    if (is_named(channel.transfer)) return transfer_function_for(channel.transfer, subject);
    if (count == 1 || (index == 0 && is_named(of_scene))) return transfer_function_for(of_scene, subject);
    constexpr Rgb colours[max_channels]{{1, 0.1, 0.1}, {0.1, 1, 0.1}, {0.15, 0.3, 1}, {1, 1, 1},
                                        {0.1, 1, 1},   {1, 0.1, 1},   {1, 1, 0.1},    {1, 0.55, 0.1}};
    // Half of the voxels are taken for background, and a tenth of what rises above them for haze.
    const Statistics& s = subject.statistics;
    const double top = s.p999 > s.p50 ? s.p999 : s.max > s.p50 ? s.max : s.p50 + 1;
    TransferFunction tf;
    const Rgb colour = subject.component.rgb.value_or(colours[index % max_channels]);
    tf.points = {{s.p50 + 0.1 * (top - s.p50), colour, 0}, {top, colour, 0.3}};
    return tf;
}

TransferFunction of_luminance(const TransferSettings& settings, const Subject& subject) {
    return transfer_function_of_channel({}, 0, 4, settings, subject);
}

TransferFunction of_alpha(const TransferSettings& settings, const Subject& subject) {
    if (is_named(settings)) return transfer_function_for(settings, subject);
    constexpr Rgb grey{0.7, 0.7, 0.7};
    constexpr double most = 0.95;  // of a voxel, as of labels alone
    return {.points = {{0, grey, 0}, {white_of(subject.statistics.max), grey, most}}};
}

double white_of(double most) {
    if (most <= 1) return 1;
    return std::max(255.0, std::exp2(std::ceil(std::log2(most + 1))) - 1);
}

TransferFunction of_labels_alone(const TransferSettings& settings, const Subject& subject) {
    TransferSettings white = settings;
    white.window.reset();
    if (is_named(settings)) return transfer_function_for(settings, subject);
    constexpr Rgb color{0.9, 0.9, 0.9};
    constexpr double opacity = 0.95;  // of a voxel: light ends within two
    const double low = subject.statistics.min, high = std::max(subject.statistics.max, low + 1);
    white.points = TransferFunction{.points = {{low, color, opacity}, {high, color, opacity}}};
    return transfer_function_for(white, subject);
}

Shape shape_for(const Scene& scene) {
    Shape shape{.mode = scene.mode, .iso = scene.iso, .clip = scene.clip};
    if (scene.transfer.threshold) {
        shape.threshold_low = scene.transfer.threshold->first;
        shape.threshold_high = scene.transfer.threshold->second;
    }
    shape.opacity_scale = scene.transfer.opacity_scale;
    shape.color = scene.output.color;
    const bool by_texture = scene.interpolation == Interpolation::texture;
    shape.interpolation = by_texture ? Interpolation::texture : Interpolation::linear;
    return shape;
}

bool has_finer_interpolation(const Scene& scene) {
    // Between the numbers of materials nothing is: classified first, they stay as they are.
    if (scene.interpolation == Interpolation::automatic && scene.sampling.classification == Classification::pre)
        return false;
    if (scene.interpolation == Interpolation::automatic && are_labels_alone(scene)) return false;
    return scene.interpolation != Interpolation::linear && scene.interpolation != Interpolation::texture;
}

bool has_linear_drafts(const Scene& scene) {
    return scene.interpolation == Interpolation::automatic && has_finer_interpolation(scene);
}

bool sees_opacities_alone(const IlluminationSettings& settings) {
    return settings.method == Method::spao || settings.method == Method::visibility;
}

TransferSettings without_colors(TransferSettings settings) {
    if (!settings.points) return settings;
    settings.points->rgb_space = RgbSpace::srgb, settings.points->name.clear();
    for (ControlPoint& point : settings.points->points) point.rgb = {0, 0, 0}, point.name.clear();
    return settings;
}

Medium finely_interpolated(const Device& device, const Medium& medium, const Scene& scene, double noise,
                           const Progress& progress) {
    const bool is_automatic = scene.interpolation == Interpolation::automatic;
    return with_interpolation(
        device, medium, is_automatic ? interpolation_for(medium, noise, progress) : scene.interpolation, progress);
}

bool looks_at_visible_voxels(const Scene& scene) {
    const Method method = scene.illumination.method;
    return scene.sampling.classification != Classification::preintegrated &&
           (method == Method::none || method == Method::spao);
}

Probe load_probe(const Lighting& lighting) {
    const std::string& source = lighting.probe.source;
    return source == lights_probe ? probe_of_lights(lighting.lights) : load_probe(source);
}

void turn_by_frame(ProbeSettings& probe, World world) {
    if (!probe.by_frame) return;
    probe.by_frame = false;
    CameraSettings first;
    const double elsewhere_deg = first.azimuth_deg;
    first.by_frame = true;
    look_from(first, world);
    probe.rotation_deg = first.azimuth_deg - elsewhere_deg;
}

Lighting with_probe(Lighting lighting) {
    if (!lighting.probe.source.empty()) lighting.loaded_probe = load_probe(lighting);
    return lighting;
}

}  // namespace chiaro
