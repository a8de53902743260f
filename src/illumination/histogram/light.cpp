#include "illumination/histogram/light.h"

#include <chiaro/error.h>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/histogram/glow.h"
#include "illumination/histogram/launch.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

const OpticalTable::Entry& entry_at(const OpticalTable& table, double stored) {
    const double last = double(table.entries.size()) - 1;
    return table.entries[std::size_t(std::clamp(table.index_of(stored) + 0.5, 0.0, last))];
}

/// The material behind isosurfaces, at one value.
void add_material(const Medium::Data& medium, double value, const OpticalTable::Entry& entry, BinOptics& optics) {
    double clear = 1;
    const IsoSurface* highest = nullptr;
    for (const IsoSurface& s : medium.shape.iso) {
        if (value < s.value) continue;
        clear *= 1 - s.opacity;
        if (!highest || s.value > highest->value) highest = &s;
    }
    std::array<float, 3> rgb{entry.r, entry.g, entry.b};
    if (highest && highest->color)
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = float(medium.shape.color == ColorMode::linear ? linear_from_srgb((*highest->color)[c])
                                                                   : (*highest->color)[c]);
    optics.alpha.push_back(float(1 - clear)), optics.rgb.push_back(rgb);
}

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

kernel::HistogramView view_over(const LocalHistograms& h, const VoxelBuffer& identifiers, const Medium::Data& medium) {
    const auto [nx, ny, nz] = h.nodes;
    const auto scale = [&](int axis) { return 1 / (h.grid.voxels_per_cell[axis] * h.subsample); };
    // voxel = (cell + ½) k - ½, cell = node × subsample
    const auto shift = [&](int axis) { return float((0.5 / h.grid.voxels_per_cell[axis] - 0.5) / h.subsample); };
    const auto before_last = [](int n) { return std::max(n - 2, 0); };
    kernel::HistogramView view{};
    view.identifiers = reinterpret_cast<const float*>(identifiers.data());
    view.row = ny > 1 ? nx : 0, view.slice = nz > 1 ? nx * ny : 0;
    view.last = {float(nx - 1), float(ny - 1), float(nz - 1)};
    view.last_x = before_last(nx), view.last_y = before_last(ny), view.last_z = before_last(nz);
    view.nodes_per_voxel = {float(scale(0)), float(scale(1)), float(scale(2))};
    view.shift = {shift(0), shift(1), shift(2)};
    view.scale = float(medium.table.index_scale), view.offset = float(medium.table.index_offset + 0.5);
    view.highest = float(medium.table.entries.size() - 1);
    view.strength = 1;
    return view;
}

/// Half of what words get wrong of the share of matter around (its RMSE, for matter of opacity 1).
constexpr float share_of_noise = 0;

/// Bleeding (1 - v) E / O and v; v = exp(-r O), or the paper's 1 - O. `least` is what of O is noise: the exponential
/// would show .02 of it, on a flat surface of opaque matter, as stains a third darker.
kernel::Rgba word_light(const std::array<float, 4>& sums, float least, const LocalHistograms& h, HistogramModel model) {
    const float o = std::clamp(sums[3] - least, 0.0f, 1.0f);
    const float v = model == HistogramModel::paper ? 1 - o : std::exp(-float(h.radius) * o);
    const float share = sums[3] > 1e-9f ? (1 - v) / sums[3] : 0;
    return {share * sums[0], share * sums[1], share * sums[2], v};
}

/// G = Σ α_j (h_j - 1) / (h_max - 1) LH_j of every word, with its colour, as opacity of one edge. The paper takes it
/// for that, which makes solid clouds; here it is the opacity of a length of r.
std::vector<kernel::Rgba> glow_of_words(const Device& device, const LocalHistograms& h, BinOptics optics,
                                        HistogramModel model) {
    const float highest = *std::max_element(optics.glow.begin(), optics.glow.end());
    for (std::size_t j = 0; j < optics.alpha.size(); ++j)
        optics.alpha[j] *= (optics.glow[j] - 1) / std::max(highest - 1, 1e-6f);
    optics.glow.clear();
    std::vector<kernel::Rgba> words;
    for (const auto& [r, g, b, sum] : word_sums(device, h, optics)) {
        const float share = std::min(sum, 0.999f);
        const float edge = model == HistogramModel::paper ? share : -std::expm1(std::log1p(-share) / float(h.radius));
        const float scale = sum > 0 ? edge / sum : 0;
        words.push_back({scale * r, scale * g, scale * b, edge});
    }
    return words;
}

/// The medium's occupancy, and every cell that the light of one that glows may reach.
std::vector<std::uint8_t> glowing_occupancy(const Medium::Data& medium, const LocalHistograms& h,
                                            const BinOptics& optics) {
    const DeviceVolume::Data& volume = medium.volume.data();
    CellRanges ranges = volume.cells;
    const auto [nx, ny, nz] = ranges.count;
    std::vector<int> before(optics.alpha.size() + 1, 0);  // bins that glow
    for (std::size_t j = 0; j < optics.alpha.size(); ++j)
        before[j + 1] = before[j] + (optics.alpha[j] > 0 && optics.glow[j] > 1);
    const double reach_mm = (h.radius + 2) * h.grid.edge_mm;
    std::array<int, 3> reach;
    for (int axis = 0; axis < 3; ++axis)
        reach[axis] = int(std::ceil(reach_mm / (volume.geometry.spacing_mm[axis] * cell_edge))) + 1;
    constexpr float lit = std::numeric_limits<float>::quiet_NaN();
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t cell = (std::size_t(z) * ny + std::size_t(y)) * nx + std::size_t(x);
                if (before[h.binning.bin_of(volume.cells.high[cell]) + 1u] ==
                    before[h.binning.bin_of(volume.cells.low[cell])])
                    continue;
                for (int k = std::max(z - reach[2], 0); k <= std::min(z + reach[2], nz - 1); ++k)
                    for (int j = std::max(y - reach[1], 0); j <= std::min(y + reach[1], ny - 1); ++j) {
                        const auto row = ranges.low.begin() + (std::ptrdiff_t(k) * ny + j) * nx;
                        std::fill(row + std::max(x - reach[0], 0), row + std::min(x + reach[0], nx - 1) + 1, lit);
                    }
            }
    const RangeTest visible = visible_range(medium.table);
    double occupied = 0;
    return make_occupancy(
        ranges, [&](float low, float high) { return std::isnan(low) || visible(low, high); }, volume.device.threads,
        occupied);
}

}  // namespace

BinOptics optics_of_bins(const Medium::Data& medium, const LocalHistograms& h, const std::string& glow) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const double edge_mm = volume.geometry.smallest_spacing_mm();
    BinOptics optics;
    const auto glowing = glow.empty() ? GlowMapping() : GlowMapping(glow);
    for (int j = 0; j < h.binning.count; ++j) {
        const double stored = h.binning.stored_of(j), value = volume.scale * stored + volume.offset;
        const OpticalTable::Entry& entry = entry_at(medium.table, stored);
        if (medium.shape.mode == Mode::iso) {
            add_material(medium, value, entry, optics);
        } else {
            optics.alpha.push_back(float(-std::expm1(-entry.extinction_per_mm * edge_mm)));
            optics.rgb.push_back({entry.r, entry.g, entry.b});
        }
        if (!glow.empty()) optics.glow.push_back(float(glowing.at(value)));
    }
    return optics;
}

std::vector<std::array<float, 4>> word_sums(const Device& device, const LocalHistograms& h, const BinOptics& optics) {
    const auto stride = std::size_t(h.stride);
    std::vector<float> weights(4 * stride);
    std::size_t first = stride, end = 0;
    for (std::size_t j = 0; j < optics.alpha.size(); ++j) {
        const float alpha = optics.alpha[j], glow = optics.glow.empty() ? 1 : optics.glow[j];
        for (std::size_t c = 0; c < 3; ++c) weights[c * stride + j] = alpha * glow * optics.rgb[j][c];
        weights[3 * stride + j] = alpha;
        if (alpha > 0) first = std::min(first, j / 16 * 16), end = j + 1;
    }
    std::vector<std::array<float, 4>> sums(std::size_t(h.words), {0, 0, 0, 0});
    if (end == 0) return sums;
    const auto kernels = kernel::histogram_functions_for(device.isa);
    parallel_for(device.threads, h.words, 64, [&](std::int64_t from, std::int64_t to) {
        kernels.word_sums(h.shares.data() + std::size_t(from) * stride, std::int32_t(to - from), h.stride,
                          std::int32_t(first), std::int32_t(end), weights.data(), sums[std::size_t(from)].data());
        for (auto w = std::size_t(from); w < std::size_t(to); ++w)
            for (float& sum : sums[w]) sum *= h.scale[w];
    });
    return sums;
}

std::shared_ptr<const HistogramLight> make_histogram_light(const Device& device, const Medium::Data& medium,
                                                           std::shared_ptr<const LocalHistograms> histograms,
                                                           const HistogramSettings& settings) {
    auto light = std::make_shared<HistogramLight>();
    const LocalHistograms& h = *histograms;
    const auto& effects = settings.effects;
    const BinOptics optics = optics_of_bins(medium, h, effects.glow ? settings.glow : "");
    const bool is_paper = settings.model == HistogramModel::paper;
    const float densest = *std::max_element(optics.alpha.begin(), optics.alpha.end());
    for (const auto& sums : word_sums(device, h, optics))
        light->words.push_back(word_light(sums, is_paper ? 0 : share_of_noise * densest, h, settings.model));
    light->side = outward_sides(medium, h.grid.edge_mm);
    for (const auto& entry : medium.table.entries) light->albedo.push_back({entry.r, entry.g, entry.b, 1});
    light->view = view_over(h, is_paper ? h.identifiers : h.lifted, medium);
    kernel::HistogramView& view = light->view;
    view.words = light->words.data(), view.side = light->side.data(), view.albedo = light->albedo.data();
    view.shows_ao = effects.ao, view.shows_bleeding = effects.bleeding;
    view.anisotropy = float(settings.anisotropy), view.scatters = effects.scattering;
    view.is_surface = medium.shape.mode == Mode::iso, view.is_paper = is_paper;
    if (!optics.glow.empty() && medium.shape.mode == Mode::dvr) {
        light->glow = glow_of_words(device, h, optics, settings.model),
        light->occupancy = glowing_occupancy(medium, h, optics);
        view.glows = true, view.glow_words = light->glow.data(), view.occupancy = light->occupancy.data();
    }
    light->histograms = std::move(histograms);
    return light;
}

Volume histogram_field(const Device& device, const Medium::Data& medium, const LocalHistograms& h,
                       const HistogramSettings& settings, Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    std::vector<kernel::Rgba> words;
    for (const auto& s : word_sums(device, h, optics_of_bins(medium, h, settings.effects.glow ? settings.glow : "")))
        words.push_back({s[0], s[1], s[2], std::min(s[3], 1.0f)});
    const std::vector<float> side = outward_sides(medium, h.grid.edge_mm);
    kernel::HistogramView view = view_over(h, h.identifiers, medium);
    view.words = words.data(), view.side = side.data(), view.is_paper = true;  // of both halves the mean

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
