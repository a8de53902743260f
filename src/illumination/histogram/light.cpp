#include "illumination/histogram/light.h"

#include "core/threads.h"
#include "illumination/histogram/emission.h"
#include "illumination/histogram/optics.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// Smallest voxel edges off a surface, beyond a sample's depth in it, where codewords are read, which are those of the
/// node one further outwards. On balls: 2.9 % at worst with 0, 2.1 with .1, 1.6 with .3 (soft edges); but flat walls
/// between voxels of one value and another, beyond which no gradient tells outwards, show rings with .3. Pictures of
/// brains, engine, menger and tubes under white against paths of light hardly differ. Isosurfaces have no skin, and
/// none.
constexpr float codeword_lift = 0.1f;

/// Which half ball faces outwards, -∇α = -α' ∇f: backward where α' > 0. Matter behind an isosurface has higher values.
std::vector<float> outward_sides(const Medium::Data& medium, double edge_mm) {
    const auto& entries = medium.table.entries;
    std::vector<float> sides(entries.size());
    const double rising = medium.volume.data().scale < 0 ? 1 : -1;
    const auto alpha = [&](std::size_t j) { return -std::expm1(-entries[j].extinction_per_mm * edge_mm); };
    for (std::size_t j = 0; j < sides.size(); ++j) {
        const double slope = alpha(std::min(j + 1, sides.size() - 1)) - alpha(j > 0 ? j - 1 : 0);
        sides[j] = medium.shape.mode == Mode::iso ? float(rising) : slope > 1e-6 ? -1.0f : slope < -1e-6 ? 1.0f : 0.0f;
    }
    return sides;
}

/// Without values: the side that most of the rises and falls of extinction have, and the mean colour.
void forget_values(const Medium::Data& medium, HistogramLight& light) {
    double side = 0, weights = 1e-12, r = 0, g = 0, b = 0;
    for (float its : light.side) side += double(its);
    for (const auto& e : medium.table.entries) {
        const double kappa = double(e.extinction_per_mm);
        weights += kappa, r += kappa * double(e.r), g += kappa * double(e.g), b += kappa * double(e.b);
    }
    std::fill(light.side.begin(), light.side.end(), side > 0 ? 1.0f : -1.0f);
    const kernel::Rgba mean{float(r / weights), float(g / weights), float(b / weights), 1};
    std::fill(light.albedo.begin(), light.albedo.end(), mean);
}

/// Node i lies at cell i × subsample.
kernel::GridView view_of_nodes(const LocalHistograms& h) {
    CellGrid nodes = h.grid;
    nodes.count = h.nodes;
    kernel::GridView grid = view_of(nodes);
    for (kernel::Float3* of_cells : {&grid.nodes_per_voxel, &grid.shift})
        *of_cells = {of_cells->x / float(h.subsample), of_cells->y / float(h.subsample),
                     of_cells->z / float(h.subsample)};
    return grid;
}

kernel::HistogramView view_over(const LocalHistograms& h, const std::byte* identifiers, const Medium::Data& medium) {
    kernel::HistogramView view{};
    view.identifiers = reinterpret_cast<const float*>(identifiers);
    view.grid = view_of_nodes(h);
    view.scale = float(medium.table.index_scale), view.offset = float(medium.table.index_offset + 0.5);
    view.highest = float(medium.table.entries.size() - 1);
    view.strength = 1;
    return view;
}

/// Bleeding (1 - v) E / O and v; v = exp(-r O), or the published 1 - O.
kernel::Rgba codeword_light(const std::array<float, 4>& sums, const LocalHistograms& h, HistogramModel model) {
    const float o = std::clamp(sums[3], 0.0f, 1.0f);
    const float v = model == HistogramModel::paper ? 1 - o : std::exp(-float(h.radius) * o);
    const float share = sums[3] > 1e-9f ? (1 - v) / sums[3] : 0;
    return {share * sums[0], share * sums[1], share * sums[2], v};
}

}  // namespace

std::shared_ptr<const HistogramLight> make_histogram_light(const Device& device, const Medium::Data& medium,
                                                           std::shared_ptr<const LocalHistograms> histograms,
                                                           const HistogramSettings& settings, bool in_mixture) {
    auto light = std::make_shared<HistogramLight>();
    const LocalHistograms& h = *histograms;
    const auto& effects = settings.effects;
    const BinOptics optics = optics_of_bins(medium, h, effects.emission ? settings.emission : "");
    const bool is_paper = settings.model == HistogramModel::paper;
    for (const auto& sums : codeword_sums(device, h, optics))
        light->codewords.push_back(codeword_light(sums, h, settings.model));
    light->side = outward_sides(medium, h.grid.edge_mm);
    for (const auto& entry : medium.table.entries) light->albedo.push_back({entry.r, entry.g, entry.b, 1});
    if (in_mixture) forget_values(medium, *light);
    light->view = view_over(h, is_paper ? h.identifiers.data() : h.displaced.address(), medium);
    kernel::HistogramView& view = light->view;
    view.codewords = light->codewords.data(), view.side = light->side.data(), view.albedo = light->albedo.data();
    view.shows_ao = effects.ao, view.shows_bleeding = effects.bleeding;
    view.anisotropy = float(settings.anisotropy), view.scatters = effects.scattering;
    view.is_surface = medium.shape.mode == Mode::iso, view.is_paper = is_paper;
    view.of_surfaces = !is_paper, view.lift_edges = view.is_surface ? 0 : codeword_lift,
    view.off_surface = off_surface_of(medium.volume.geometry());
    if (!optics.emission.empty() && medium.shape.mode == Mode::dvr) {
        h.displaced.array().fetch();
        light->emission = emission_of_codewords(device, h, optics, settings.model);
        view.emits = true, view.emission_codewords = light->emission.data();
        light->occupancy = emissive_occupancy(device, medium, h, view);
        view.occupancy = light->occupancy.data();
    }
    light->histograms = std::move(histograms);
    return light;
}

ParticleLight light_on_particles(const Device& device, const Medium::Data& medium, const LocalHistograms& h,
                                 const HistogramSettings& settings) {
    std::vector<float> open;
    for (const auto& sums : codeword_sums(device, h, optics_of_bins(medium, h, "")))
        open.push_back(codeword_light(sums, h, settings.model).a);
    CellGrid nodes = h.grid;
    nodes.count = h.nodes;
    ParticleLight light{CellValues(nodes), view_of_nodes(h)};
    const auto pairs = h.pairs();
    for (std::size_t node = 0; node < pairs.size(); ++node)
        light.open.data()[node] = cell_value(0.5 * (open[pairs[node].forward] + open[pairs[node].backward]));
    return light;
}

Volume histogram_field(const Device& device, const Medium::Data& medium, const LocalHistograms& h,
                       const HistogramSettings& settings, Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    std::vector<kernel::Rgba> codewords;
    for (const auto& s :
         codeword_sums(device, h, optics_of_bins(medium, h, settings.effects.emission ? settings.emission : "")))
        codewords.push_back({s[0], s[1], s[2], std::min(s[3], 1.0f)});
    const std::vector<float> side = outward_sides(medium, h.grid.edge_mm);
    kernel::HistogramView view = view_over(h, h.identifiers.data(), medium);
    view.codewords = codewords.data(), view.side = side.data(), view.is_paper = true;  // of both halves the mean

    const bool is_colour = settings.effects.bleeding;
    Volume out;
    out.dimensions = volume.dimensions, out.type = VoxelType::f32, out.components = is_colour ? 3 : 1;
    out.geometry = volume.geometry;
    out.voxels = VoxelBuffer(out.voxel_count() * std::size_t(out.components) * sizeof(float));
    const auto [nx, ny, nz] = out.dimensions;
    with_stored_voxel(volume, [&](auto voxel) {
        const auto voxels = view_of<decltype(voxel)>(volume);
        parallel_for(device.threads, std::int64_t(ny) * nz, 1, "voxels", progress,
                     [&, nx = nx, ny = ny](std::int64_t row, std::int64_t) {
                         float* to = out.as<float>().data() + row * nx * out.components;
                         for (int x = 0; x < nx; ++x) {
                             const kernel::Vec3<float> p(float(x), float(row % ny), float(row / ny));
                             const float value = voxels.value(voxels.locate(p, voxels.voxel(p)));
                             const auto found = view.arriving(kernel::SamplePoint<float>{p, value, 0, 0}, {});
                             if (is_colour)
                                 *to++ = found.bleeding.x, *to++ = found.bleeding.y, *to++ = found.bleeding.z;
                             else
                                 *to++ = found.open;
                         }
                     });
    });
    progress.check();
    return out;
}

}  // namespace chiaro
