#include <fmt/format.h>

#include <numbers>

#include "classify/medium.h"
#include "core/ranks.h"
#include "core/threads.h"
#include "illumination/access.h"
#include "illumination/cells/surface_share.h"
#include "illumination/field.h"
#include "illumination/floor/floor.h"
#include "illumination/prepared.h"
#include "illumination/probe/lambert.h"
#include "illumination/spao/layers.h"
#include "illumination/spao/spao.h"
#include "illumination/visibility/visibility.h"

namespace chiaro {
namespace {

/// Of A, which is what particles show.
kernel::AccessView view_of(const std::uint16_t* cells, const kernel::GridView& nodes) {
    return {.cells = cells, .grid = nodes, .strength = 1, .of_surfaces = false, .surface = {}, .off_surface = {}};
}

IlluminationField field_of(CellValues values, kernel::AccessView view, StageTimer& timer) {
    auto data = std::make_shared<IlluminationField::Data>();
    data->surfaces = view.of_surfaces;
    data->access = std::make_shared<const CellValues>(std::move(values));
    view.cells = data->access->address();  // a GPU may be all that reads it
    data->view = view;
    data->stages = timer.take();
    return IlluminationField(std::move(data));
}

IlluminationField field_of(std::shared_ptr<const LitNodes> nodes, const IlluminationSettings& settings, bool is_coarse,
                           StageTimer& timer) {
    auto data = std::make_shared<IlluminationField::Data>();
    data->surfaces = shows_surfaces(settings) && settings.visibility.model == VisibilityModel::corrected;
    data->is_coarse = is_coarse;
    data->visibility = std::move(nodes);
    data->of_visibility = settings.visibility;
    data->stages = timer.stages();
    return IlluminationField(std::move(data));
}

void check_image(const IlluminationSettings& settings) {
    const auto quantity = settings.reference.quantity;
    if (settings.method != Method::reference || !quantity) return;
    if (quantity == ReferenceQuantity::visibility || quantity == ReferenceQuantity::mean_radiance)
        throw Error(
            ErrorCode::usage,
            fmt::format("the reference's quantity {} is a field, no picture: write it with chiaro illuminate, or "
                        "choose radiance, obscurance, ao or ao-cosine",
                        quantity == ReferenceQuantity::mean_radiance ? "mean-radiance" : "visibility"));
}

/// What ranks cannot find together.
void check_shared(const IlluminationSettings& settings, const Lighting& lighting) {
    if (lighting.floor.show || lighting.probe.background)
        throw Error(ErrorCode::usage, "a volume that several ranks share is drawn without floor and background");
    if (settings.method == Method::histogram || settings.method == Method::reference)
        throw Error(
            ErrorCode::usage,
            fmt::format("lighting {} needs all voxels: of a volume that several ranks share light is found by spao, "
                        "visibility and transport",
                        settings.method == Method::histogram ? "histogram" : "reference"));
    if (settings.method == Method::spao && (!is_fused(settings.spao) || !shows_surfaces(settings)))
        throw Error(
            ErrorCode::usage,
            "lighting spao over several ranks is found with the filter automatic, the model corrected and surfaces");
}

/// The whole field is every rank's: of visibility at most 256 nodes along an axis, where those of every eighth cell are
/// no more. (transport-grid says so of any volume.)
IlluminationSettings of_shared_field(IlluminationSettings settings, const DeviceVolume& volume) {
    constexpr int most = 256, coarsest = 8;
    const CellGrid cells = make_cell_grid(volume.dimensions(), volume.geometry());
    const int longest = *std::max_element(cells.count.begin(), cells.count.end());
    int& subsample = settings.visibility.subsample;
    while (subsample < coarsest && longest > most * subsample) subsample *= 2;
    return settings;
}

IlluminationField light_of(const Device& device, const Medium::Data& medium, const IlluminationSettings& settings,
                           Progress& progress) {
    StageTimer timer;
    const bool surfaces = shows_surfaces(settings);
    const auto found = [&] {
        if (settings.method == Method::spao && is_fused(settings.spao) && surfaces && !device.has_gpu())
            return spao_light(device, medium, settings.spao, timer, progress);
        const CellOpacity opacity = timer("opacity", [&] { return cell_opacity(device, medium, progress); });
        const BlockMap asked = visible_blocks(medium, opacity.values.grid, surfaces ? access_reach : 1);
        return accessibility(device, medium, opacity, settings, asked, timer, progress, surfaces);
    };
    CellValues access = found();
    kernel::AccessView view = view_of(access.address(), view_of(access.grid));
    if (surfaces) {
        const Geometry& geometry = medium.volume.geometry();
        view.of_surfaces = true;
        view.surface = surface_access(settings, access.grid.edge_mm / geometry.smallest_spacing_mm());
        view.off_surface = off_surface_of(geometry);
    }
    return field_of(std::move(access), view, timer);
}

void light(const Device& device, const Medium::Data& medium, const IlluminationSettings& settings, const Sink& sink,
           Progress& progress, const IlluminationField& warm) {
    if (settings.method != Method::visibility) return sink(light_of(device, medium, settings, progress));
    StageTimer timer;
    const auto keep = [&](VisibilityNodes nodes, bool is_coarse) {
        sink(field_of(std::make_shared<const LitNodes>(device, std::move(nodes)), settings, is_coarse, timer));
    };
    const IlluminationField::Data& last = warm.data();
    // Ranks would have to agree on it.
    const bool is_as_asked = last.of_visibility == settings.visibility && !last.is_coarse && !device.is_shared();
    const VisibilityNodes* before = is_as_asked ? &last.visibility->nodes() : nullptr;
    if (refine_visibility(device, medium, settings.visibility, before, keep, timer, progress))
        sink(field_of(last.visibility, settings, false, timer));
}

/// Of a surface that sees half of all the light there is, whichever way it faces: per channel.
std::array<float, 3> max_on_a_surface(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry) {
    std::array<float, 3> most{};
    const float all = std::sqrt(4 * std::numbers::pi_v<float>);  // V_00 where nothing stops light
    for (const LambertTable::Entry& entry : lambert_table(lighting, orbit_up, geometry, ShWindow::none).entries)
        for (int c = 0; c < 3; ++c) most[c] = std::max(most[c], all * entry[c][0] / std::numbers::pi_v<float>);
    return most;
}

void scatter(const Device& device, const Medium::Data& medium, const Lighting& lighting,
             const IlluminationSettings& settings, const Sink& sink, Progress& progress,
             const IlluminationField& warm) {
    Lighting unexposed = above_floor(lighting);
    unexposed.probe.exposure = 0;  // a factor, which needs no light to be found again
    StageTimer timer;
    // All fields of this call share it: each leaves the newest solver.
    const auto memory = std::make_shared<TransportMemory>(warm.data().memory ? *warm.data().memory : TransportMemory{});
    const Vec3 up = lighting.probe_up.value_or(Vec3{0, 0, 1});
    const Geometry& geometry = medium.volume.geometry();
    // Pictures of particles alone look at opaque cells from outside.
    const std::array<float, 3> most =
        shows_surfaces(settings) ? std::array<float, 3>{} : max_on_a_surface(unexposed, up, geometry);
    std::shared_ptr<const TransportLight> before = warm.data().transport;
    const auto keep = [&](TransportNodes nodes, bool is_coarse) {
        auto data = std::make_shared<IlluminationField::Data>();
        const double edges = nodes.grid.edge_mm / geometry.smallest_spacing_mm();
        data->transport = std::make_shared<const TransportLight>(device, std::move(nodes), edges, most, before.get());
        if (!before || before->nodes().grid.size() <= data->transport->nodes().grid.size()) before = data->transport;
        data->memory = memory;
        data->albedo_limit = settings.scattering.albedo_limit();
        data->surfaces = shows_surfaces(settings);
        data->is_coarse = is_coarse;
        data->stages = timer.stages();
        sink(IlluminationField(std::move(data)));
    };
    refine_transport(device, medium, unexposed, settings.transport, settings.scattering, surface_model(settings), up,
                     keep, timer, progress, memory.get());
}

/// A cell's number at every voxel's centre; interpolated where voxels are no cubes.
Volume sampled_back(const Device& device, const CellValues& values, const DeviceVolume& volume, Progress& progress) {
    Volume out = make_volume(volume.dimensions(), VoxelType::f32);
    out.geometry = volume.geometry();
    const kernel::AccessView view = view_of(values.data(), view_of(values.grid));
    const auto [nx, ny, nz] = out.dimensions;
    const auto fill_row = [&, nx = nx, ny = ny](std::int64_t row, std::int64_t) {
        float* to = out.as<float>().data() + row * nx;
        for (int x = 0; x < nx; ++x) to[x] = view.at(kernel::Vec3<float>(float(x), float(row % ny), float(row / ny)));
    };
    parallel_for(device.threads, std::int64_t(ny) * nz, 1, "voxels", progress, fill_row);
    progress.check();
    return out;
}

/// What was prepared, if it is what the method needs.
const std::shared_ptr<const LocalHistograms>& histograms_of(const Prepared& prepared) {
    if (!prepared || !prepared.data().histograms)
        throw Error(ErrorCode::internal, "local histograms must be prepared before they can light");
    return prepared.data().histograms;
}

/// The medium whose values were counted: of several channels the one that is asked for, of own colours their opacity's.
const Medium::Data& counted_medium(const Medium::Data& mixture, const Prepared& prepared,
                                   const HistogramSettings& settings) {
    const auto refuse = [](const char* sentence) {
        throw Error(ErrorCode::usage, std::string("lighting histogram: ") + sentence);
    };
    const auto& mixed = mixture.volume.data().mixture;
    if (mixture.surface_labels || (mixed && mixed->labels))
        refuse("local histograms know no labels, which go with spao, visibility, transport and reference");
    if (!mixed) return mixture;
    const MixtureOfChannels& parts = *mixed;
    if (settings.effects.emission && !settings.emission.empty())
        refuse("--glow is of a volume of one channel, and not of one in its own colours");
    if (parts.own_colors || mixture.channels.size() == 1) return *mixture.channels.front();
    if (settings.channel == 0)
        refuse(
            "local histograms are of one channel: --hist-channel N chooses one; several go with spao, visibility, "
            "transport and reference");
    for (const auto& channel : mixture.channels)
        if (prepared && is_look_at(channel->volume.data(), prepared.data().volume.data())) return *channel;
    refuse("the channel that --hist-channel chooses is not shown");
    return mixture;
}

IlluminationField light_of_histograms(const Device& device, const Medium::Data& shown, const Prepared& prepared,
                                      const IlluminationSettings& settings) {
    const Medium::Data& medium = counted_medium(shown, prepared, settings.histogram);
    if (medium.volume.data().factor)
        throw Error(ErrorCode::usage,
                    "lighting histogram: local histograms know values and no gradients, so opacity by gradient goes "
                    "with spao, visibility, transport and reference");
    StageTimer timer;
    if (!shows_surfaces(settings)) {
        ParticleLight light = timer("histogram table", [&] {
            return light_on_particles(device, medium, *histograms_of(prepared), settings.histogram);
        });
        const kernel::AccessView view = view_of(light.open.address(), light.nodes);
        return field_of(std::move(light.open), view, timer);
    }
    auto data = std::make_shared<IlluminationField::Data>();
    data->histogram = timer("histogram table", [&] {
        return make_histogram_light(device, medium, histograms_of(prepared), settings.histogram, is_mixed(shown));
    });
    data->view = data->histogram->view;
    data->stages = timer.take();
    return IlluminationField(std::move(data));
}

}  // namespace

Volume field_of_voxels(const Device& device, const Medium::Data& medium, const Prepared& prepared,
                       const IlluminationSettings& settings, StageTimer& timer, Progress& progress) {
    if (settings.method == Method::histogram)
        return timer("voxels", [&] {
            return histogram_field(device, counted_medium(medium, prepared, settings.histogram),
                                   *histograms_of(prepared), settings.histogram, progress);
        });
    return accessibility_of_voxels(device, medium, settings, timer, progress);
}

Volume accessibility_of_voxels(const Device& device, const Medium::Data& medium, const IlluminationSettings& settings,
                               StageTimer& timer, Progress& progress) {
    const CellOpacity opacity = timer("opacity", [&] { return cell_opacity(device, medium, progress); });
    const BlockMap all(opacity.values.grid.count, true);
    const CellValues access = accessibility(device, medium, opacity, settings, all, timer, progress);
    return timer("voxels", [&] { return sampled_back(device, access, medium.volume, progress); });
}

IlluminationField::IlluminationField() : data_(std::make_shared<Data>()) {}
std::size_t IlluminationField::bytes() const {
    return (data().access ? data().access->buffer.size() : 0) + (data().visibility ? data().visibility->bytes() : 0) +
           (data().histogram ? data().histogram->bytes() : 0) + (data().transport ? data().transport->bytes() : 0);
}
bool IlluminationField::is_coarse() const { return data().is_coarse; }
const std::vector<Stage>& IlluminationField::stages() const { return data().stages; }

std::vector<MethodInfo> list_methods() {
    return {
        {"none", "All light arrives everywhere; only the shading model acts."},
        {"spao", "Ambient occlusion by filtering: means of growing cubes, found again after every edit."},
        {"visibility", "Light of an environment map, with soft coloured shadows: visibility in spherical harmonics."},
        {"histogram",
         "Ambient occlusion and colour bleeding by local histograms: prepared once, an edit only renews a small "
         "table."},
        {"transport",
         "Multiple scattering by discrete ordinates on a grid, live after an edit: each iteration brings it nearer."},
        {"reference",
         "Ground truth by path tracing, or by rays from every voxel: slow; the others are measured against it."}};
}

bool illuminate(const Device& given, const Medium& medium, const Prepared& prepared, const Lighting& lighting,
                const IlluminationSettings& asked, const Sink& sink, Progress& progress,
                const IlluminationField& warm) try {
    progress.check();
    const Device device = device_for(given, medium.data());
    check_image(asked);
    if (device.is_shared()) check_shared(asked, lighting);
    const IlluminationSettings settings = device.is_shared() ? of_shared_field(asked, medium.data().volume) : asked;
    // Paths find their light themselves.
    if (settings.method == Method::none || !is_lit(medium.data().shape.mode) || is_path_traced(settings))
        sink(IlluminationField());
    else if (settings.method == Method::transport)
        collectively(device, [&] { scatter(device, medium.data(), lighting, settings, sink, progress, warm); });
    else if (settings.method == Method::histogram)
        sink(light_of_histograms(device, medium.data(), prepared, settings));
    else
        collectively(device, [&] { light(device, medium.data(), settings, sink, progress, warm); });
    return true;
} catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) return false;
    throw;
}

}  // namespace chiaro
