// From public settings to what the kernel reads. Shared by the CPU and later back ends.
#pragma once
#include <chiaro/render.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "classify/medium.h"
#include "classify/segments.h"
#include "classify/surface_table.h"
#include "illumination/lit_field.h"
#include "raycast/kernel.h"
#include "volume/device_view.h"

namespace chiaro {

/// Of the view, in the unit of its half height.
double half_width(const Camera& camera, int width, int height);
kernel::CameraView camera_view(const Camera& camera, const Geometry& geometry, int width, int height);
kernel::ShadingView shading_view(const Lighting& lighting, const Camera& camera, const DeviceVolume::Data& volume,
                                 ColorMode color);
/// Highlights come from a probe's main direction; its colour is told by what arrives.
void shine_from(const MainLight& light, const Lighting& lighting, const Camera& camera, kernel::ShadingView& shading);
/// The distance of the samples along a ray. No ray has more than 2^23 of them, behind which floats cannot count: k + ½
/// would be k, and a ray would never end.
double step_mm(double step_voxels, const Geometry& geometry, const std::array<int, 3>& dimensions);

/// The optical table for steps of `step_mm`: α = 1 - exp(-κ h), colours premultiplied.
std::vector<kernel::Rgba> step_table(const OpticalTable& table, double step_mm);
/// The same of what adds up: κ h.
std::vector<kernel::Rgba> emission_table(const OpticalTable& table, double step_mm);

/// How much colours change between each entry and the nearest one of no opacity (kernel::OnsetTableView). What lies
/// beyond the table has none.
std::vector<float> onset_table(const std::vector<kernel::Rgba>& steps);

/// What the kernel looks colours up in.
struct RayTables {
    std::vector<kernel::Rgba> steps;
    std::vector<float> onsets;  ///< of the steps; empty where rays are not refined
    std::shared_ptr<const SurfaceTable> surface;
    std::shared_ptr<const ShareTable> shares;
    std::shared_ptr<const SegmentTable> segments;  ///< null unless needed

    void add_to(HostArrays& arrays) const {
        arrays.add(steps), arrays.add(onsets);
        if (surface) arrays.add(surface, surface->opacity());
        if (shares) arrays.add(shares, shares->shares()), arrays.add(shares, shares->depths());
        if (!segments) return;
        arrays.add(segments, segments->entries);
        arrays.add(segments, segments->visible_before);
    }
};
/// `lit`: what the rays see, whose colours may be limited; null: no light.
RayTables make_tables(const Medium::Data& medium, const RaySettings& settings, int threads,
                      const LitField* lit = nullptr);
kernel::StepTableView step_table_view(const OpticalTable& table, const RayTables& tables);
/// `table`: may be null.
kernel::SegmentTableView segment_table_view(const SegmentTable* table);

kernel::ClipView clip_view(const Clip& clip, const Geometry& geometry, const std::array<int, 3>& dimensions);
/// By steps of so many smallest voxel edges.
kernel::SolidView solid_view(double step_voxels);
kernel::SurfacesView surfaces_view(const Medium::Data& medium, bool backwards, std::optional<double> albedo_limit = {});

/// Throws Error{usage} where rays are to end in a picture of another size.
void check_ends(const RaySettings& settings, const Frame& frame);
kernel::March march_of(Mode mode);
/// Throws Error{usage} where opacity by gradient goes with another classification than post.
kernel::MarchOptions march_options(const RaySettings& settings, const Medium::Data& medium);
/// What samples are taken of: where labels only tint, the channel itself.
inline const DeviceVolume::Data& marched_volume(const Medium::Data& medium, const LabelBricks* labels) {
    return labels && !labels->cuts() ? medium.channels.front()->volume.data() : medium.volume.data();
}
/// Smallest voxel edges behind it that a surface counts where a ray has met it.
inline constexpr double surface_reach = 2;
/// What of the volume is this rank's to show.
kernel::OwnBox own_box(const Medium::Data& medium, double step_voxels);
kernel::ExtremeView extreme_view(const DeviceVolume::Data& volume, Mode mode);

/// Through each pixel, at least, where a lens blurs what is not in focus.
inline constexpr int lens_rays = 64;
inline int rays_per_pixel(const Camera& camera, const RaySettings& settings) {
    return camera.aperture_mm > 0 ? std::max(settings.samples_per_pixel, lens_rays) : settings.samples_per_pixel;
}

/// Everything but the voxels' type and the field: the members that all kernels share.
template <class Voxel, class Field>
kernel::RaycastKernel<Voxel, Field> make_kernel(const Medium::Data& medium, const RayTables& tables, const Field& field,
                                                const Lighting& lighting, const Camera& camera,
                                                const RaySettings& settings, Frame& frame, bool shows_cuts,
                                                std::optional<double> albedo_limit = {}) {
    const kernel::MarchOptions way = march_options(settings, medium);
    const auto& lie_in = way.labelled ? medium.volume.data().mixture->labels : medium.surface_labels;
    const LabelBricks* const labels = lie_in.get();
    const DeviceVolume::Data& volume = marched_volume(medium, way.labelled ? labels : nullptr);
    const auto [nx, ny, nz] = volume.dimensions;
    // An axis of one voxel is one voxel thick.
    const auto low = [](int n) { return n == 1 ? -0.5f : 0.0f; };
    const auto high = [](int n) { return n == 1 ? 0.5f : float(n - 1); };
    const bool backwards = settings.compositing == Compositing::back_to_front;
    return {
        .matter = {.volume = view_of<Voxel>(volume),
                   .occupancy = {medium.cells.data(), cell_count(nx), cell_count(ny)},
                   .table = step_table_view(medium.table, tables),
                   .onsets = {tables.onsets.data()},
                   .segments = segment_table_view(tables.segments.get()),
                   .step = {float(step_mm(settings.step_voxels, volume.geometry, volume.dimensions)),
                            float(albedo_limit.value_or(std::numeric_limits<double>::infinity()))},
                   .labels = label_view(labels),
                   .shading = shading_view(is_lit(medium.shape.mode) ? lighting : Lighting{.shading = Shading::none},
                                           camera, volume, medium.shape.color),
                   .field = field,
                   .cutoff = float(settings.early_termination),
                   .cut_alpha = float(1 - std::exp2(-settings.step_voxels)),  // ½ over one voxel
                   .solid = solid_view(settings.step_voxels),
                   .surface = tables.surface ? tables.surface->view() : kernel::SurfaceView{},
                   .shares = tables.shares ? tables.shares->view() : kernel::ShareTableView{},
                   .met_steps = float(surface_reach / settings.step_voxels),
                   .refines = !tables.onsets.empty(),
                   .skip_empty = settings.skip_empty || volume.pages,  // which also tells what is seen
                   .shows_cuts = shows_cuts},
        .camera = camera_view(camera, volume.geometry, frame.width, frame.height),
        .frame = {reinterpret_cast<kernel::Rgba*>(frame.rgba.data()), frame.width,
                  settings.ends ? settings.ends->mm.data() : nullptr},
        .box_low = {low(nx), low(ny), low(nz)},
        .box_high = {high(nx), high(ny), high(nz)},
        .clip_view = clip_view(medium.shape.clip, volume.geometry, volume.dimensions),
        .surfaces = surfaces_view(medium, backwards, albedo_limit),
        .extreme = extreme_view(volume, medium.shape.mode),
        .mode = march_of(medium.shape.mode),
        .way = way,
        .step_mm = float(step_mm(settings.step_voxels, volume.geometry, volume.dimensions)),
        .rays_per_pixel = rays_per_pixel(camera, settings),
        .bounds = {},
        .own = own_box(medium, settings.step_voxels),
    };
}

}  // namespace chiaro
