#include "illumination/transport/matter.h"

#include <cmath>
#include <limits>

#include "classify/medium.h"

namespace chiaro {
namespace {

/// Henyey and Greenstein's g by similarity: what goes on as if nothing had been, κ a g, is left out of the extinction.
/// Exact for the first moment; grey, with the mean albedo.
LightGrid similar(LightGrid grid, double g) {
    if (g == 0) return grid;
    float* extinction = grid.extinction.numbers();
    for (std::size_t i = 0; i < grid.extinction.grid.size(); ++i) {
        const double mean = (double(grid.albedo[0][i]) + grid.albedo[1][i] + grid.albedo[2][i]) / 3,
                     kept = 1 - mean * g;
        extinction[i] = float(extinction[i] * kept);
        for (auto& channel : grid.albedo) channel[i] = float(std::max(1 - (1 - channel[i]) / kept, 0.0));
    }
    return grid;
}

LatticeField albedo_of(const LightGrid& grid, const OpaqueCells& opaque, int channel, const Lattice& lattice) {
    std::vector<float> albedo = grid.albedo[channel];
    for (std::size_t node = 0; node < albedo.size(); ++node)
        if (opaque.is_opaque(node)) albedo[node] = 0;
    return spread(grid.extinction.grid, albedo.data(), lattice);
}

/// Of the 2³ cells in one, the mean albedo by extinction.
std::vector<float> halved_albedo(const LightGrid& fine, int channel, const CellGrid& coarse) {
    const CellGrid& grid = fine.extinction.grid;
    std::vector<double> colour(coarse.size()), weight(coarse.size());
    for (int z = 0; z < grid.count[2]; ++z)
        for (int y = 0; y < grid.count[1]; ++y)
            for (int x = 0; x < grid.count[0]; ++x) {
                const std::size_t from = grid.index(x, y, z), to = coarse.index(x / 2, y / 2, z / 2);
                const double extinction = fine.extinction.data()[from];
                colour[to] += extinction * fine.albedo[channel][from], weight[to] += extinction;
            }
    std::vector<float> albedo(coarse.size());
    for (std::size_t i = 0; i < albedo.size(); ++i)
        if (weight[i] > 0) albedo[i] = float(colour[i] / weight[i]);
    return albedo;
}

}  // namespace

TransportMatter::TransportMatter(LightGrid light_grid, const Geometry& volume, bool counted)
    : grid(std::move(light_grid)),
      opaque(grid, counted ? std::numeric_limits<float>::infinity() : opaque_from),
      swept(grid, opaque),
      weight(grid.extinction.grid.size()),
      geometry(volume),
      counts_bounces(counted) {
    for (int c = 0; c < 3; ++c) albedo[c] = albedo_of(grid, opaque, c, swept.lattices.along_x);
    for (std::size_t node = 0; node < weight.size(); ++node)
        weight[node] = std::max(float(-std::expm1(-grid.extinction.data()[node])), 1e-3f);
}

SharedMatter matter_of(const Device& device, const Medium::Data& medium, int cells,
                       const ScatteringSettings& scattering, Progress& progress) {
    return std::make_shared<const TransportMatter>(
        similar(light_grid(medium, cells, scattering.albedo_max, device, progress), scattering.anisotropy),
        medium.volume.geometry(), scattering.bounces.most.has_value());
}

SharedMatter halved(const TransportMatter& finer, const Device& device, Progress& progress) {
    LightGrid grid{halved(finer.grid.extinction, device, progress), {}, finer.grid.is_surface, {}};
    for (int c = 0; c < 3; ++c) grid.albedo[c] = halved_albedo(finer.grid, c, grid.extinction.grid);
    return std::make_shared<const TransportMatter>(std::move(grid), finer.geometry, finer.counts_bounces);
}

TransportNodes unlit_nodes(const TransportMatter& matter) {
    const CellGrid& grid = matter.grid.extinction.grid;
    TransportNodes out{
        grid, std::vector<float>(3 * grid.size()), matter.weight, std::vector<float>(9 * grid.size()), {}};
    if (matter.opaque.count() == 0) return out;
    out.answer.resize(3 * grid.size());
    for (std::size_t cell = 0; cell < matter.opaque.count(); ++cell)
        std::copy_n(matter.opaque.per_albedo(cell).begin(), 3,
                    out.answer.begin() + std::ptrdiff_t(3 * matter.opaque.nodes()[cell]));
    for (const std::size_t node : matter.grid.skins)
        for (int c = 0; c < 3; ++c) out.answer[3 * node + c] = float(reflected_per_albedo(matter.grid.albedo[c][node]));
    return out;
}

}  // namespace chiaro
