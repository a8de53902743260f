#include "illumination/probe/lambert.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/probe/octahedron.h"
#include "illumination/sh/window.h"

namespace chiaro {
namespace {

constexpr int edge = 65;
constexpr int values = 3 * max_coefficients;

/// Light that comes from one place: its direction, and ∫ L Y_lm dω per channel.
struct Cell {
    std::array<float, 3> direction;
    std::array<float, values> light;
};

std::vector<Cell> cells_of(const Probe::Data& probe) {
    std::vector<Cell> cells;
    for (const ProbePiece& piece : probe.pieces().all) {
        const ShCoefficients basis = spherical_harmonics(piece.direction);
        Cell& cell = cells.emplace_back(
            Cell{{float(piece.direction.x), float(piece.direction.y), float(piece.direction.z)}, {}});
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < max_coefficients; ++i)
                cell.light[c * max_coefficients + i] = float(4 * std::numbers::pi * piece.light[c] * basis[i]);
    }
    return cells;
}

/// Σ light max(0, n·ω), by runs of cells, so that single precision loses nothing.
LambertTable::Entry lambert_at(const std::vector<Cell>& cells, Vec3 normal) {
    const float nx = float(normal.x), ny = float(normal.y), nz = float(normal.z);
    std::array<double, values> sums{};
    constexpr std::size_t run = 128;
    for (std::size_t first = 0; first < cells.size(); first += run) {
        std::array<float, values> part{};
        for (std::size_t k = first; k < std::min(first + run, cells.size()); ++k) {
            const Cell& cell = cells[k];
            const float cosine = nx * cell.direction[0] + ny * cell.direction[1] + nz * cell.direction[2];
            if (cosine <= 0) continue;
            for (int i = 0; i < values; ++i) part[i] += cosine * cell.light[i];
        }
        for (int i = 0; i < values; ++i) sums[i] += part[i];
    }
    LambertTable::Entry entry;
    for (int i = 0; i < values; ++i) entry[i / max_coefficients][i % max_coefficients] = float(sums[i]);
    return entry;
}

template <class AtNormal>
LambertTable tabulated(const AtNormal& at_normal) {
    LambertTable table{edge, std::vector<LambertTable::Entry>(std::size_t(edge) * edge)};
    parallel_for(edge, 1, [&](std::int64_t first, std::int64_t last) {
        for (auto j = first; j < last; ++j)
            for (int i = 0; i < edge; ++i) table.entries[j * edge + i] = at_normal(table.normal(i, int(j)));
    });
    return table;
}

}  // namespace

Vec3 octahedron_node(int i, int j, int edge) {
    double x = 2.0 * i / (edge - 1) - 1, y = 2.0 * j / (edge - 1) - 1;
    const double z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) {
        const double folded = std::copysign(1 - std::abs(y), x);
        y = std::copysign(1 - std::abs(x), y);
        x = folded;
    }
    return normalized({x, y, z});
}

LambertTable::Entry LambertTable::at(Vec3 normal) const {
    const auto place = kernel::octahedral(kernel::Vec3<float>(float(normal.x), float(normal.y), float(normal.z)));
    const float u = place.u * float(edge - 1), v = place.v * float(edge - 1);
    const int i = std::clamp(int(u), 0, edge - 2), j = std::clamp(int(v), 0, edge - 2);
    const float x = u - float(i), y = v - float(j);
    const Entry* node = entries.data() + std::size_t(j) * edge + i;
    Entry entry;
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < max_coefficients; ++k) {
            const float near = node[0][c][k] + x * (node[1][c][k] - node[0][c][k]);
            const float far = node[edge][c][k] + x * (node[edge + 1][c][k] - node[edge][c][k]);
            entry[c][k] = near + y * (far - near);
        }
    return entry;
}

LambertTable lambert_of_probe(const Probe::Data& probe) {
    const std::vector<Cell> cells = cells_of(probe);
    return tabulated([&](Vec3 normal) { return lambert_at(cells, normal); });
}

double suitable_stops_of_probe(const Probe::Data& probe) {
    // The mean over all normals is the mean radiance; the largest is looked for some 6 degrees apart, where a cosine is
    // within .2 %.
    constexpr int normals = 33;
    double mean = 0, largest = 0;
    for (std::size_t c = 0; c < 3; ++c) mean += luminance_weights[c] * probe.sh[c][0] / std::sqrt(4 * std::numbers::pi);
    const std::vector<Cell> cells = cells_of(probe);
    const double y_00 = 1 / std::sqrt(4 * std::numbers::pi);
    for (int j = 0; j < normals; ++j)
        for (int i = 0; i < normals; ++i) {
            const Vec3 n = octahedron_node(i, j, normals);
            double irradiance = 0;
            for (const Cell& cell : cells) {
                const double cosine = n.x * cell.direction[0] + n.y * cell.direction[1] + n.z * cell.direction[2];
                if (cosine <= 0) continue;
                for (std::size_t c = 0; c < 3; ++c)
                    irradiance += luminance_weights[c] * cosine * cell.light[c * max_coefficients] / y_00;
            }
            largest = std::max(largest, irradiance / std::numbers::pi);
        }
    if (!(mean > 0) || !(largest > 0)) return 0;
    const double stops = std::log2(std::min(0.45 / mean, 1.2 / largest));
    return std::clamp(std::round(100 * stops) / 100, -32.0, 32.0);
}

LambertTable lambert_table(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, ShWindow window,
                           int bands, std::span<const Lamp> left_out) {
    const Axes turn = grid_from_probe(lighting, orbit_up, geometry), probe_from_grid = transposed(turn);
    const ShRotation rotation(turn);
    std::vector<std::pair<DominantLight, ShCoefficients>> lights;
    for (const Lamp& lamp : left_out)
        for (const ShadowedLight& part : lamp)
            lights.emplace_back(part.light, spherical_harmonics(part.light.direction));
    const auto factors = window_factors(window, bands);
    const double gain = probe_gain(lighting);
    const Probe probe = lighting_probe(lighting);
    const LambertTable& own = probe.data().lambert();
    return tabulated([&](Vec3 normal) {
        LambertTable::Entry entry = own.at(turned(probe_from_grid, normal));
        std::array<ShCoefficients, 3> less{};
        for (const auto& [light, towards] : lights) {
            const double cosine = std::max(dot(normal, light.direction), 0.0);
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = 4 * std::numbers::pi * cosine * light.light[c];
                for (int i = 0; i < max_coefficients; ++i) less[c][i] += weight * towards[i];
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const auto all = rotation(entry[c]);
            for (int l = 0; l < max_bands; ++l)
                for (int i = l * l; i < (l + 1) * (l + 1); ++i)
                    entry[c][i] = float((gain * all[i] - less[c][i]) * factors[l]);
        }
        return entry;
    });
}

}  // namespace chiaro
