#include "illumination/probe/lambert.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/probe/octahedron.h"
#include "illumination/sh/window.h"

namespace chiaro {
namespace {

constexpr int cells_x = 128, cells_y = 64;
constexpr int edge = 65;
constexpr int values = 3 * max_coefficients;

/// Light that comes from one place: its direction, and ∫ L Y_lm dω per channel.
struct Cell {
    std::array<float, 3> direction;
    std::array<float, values> light;
};

/// A cell gathered from its pixels: the direction is the mean one, weighted by luminance, so that a small light keeps
/// its place. Pixels wider than half a cell are taken in pieces.
Cell gather(const ProbeImage& image, int cell_x, int cell_y) {
    const int pieces_x = 1 + (2 * cells_x - 1) / image.width, pieces_y = 1 + (2 * cells_y - 1) / image.height;
    const std::int64_t fine_x = std::int64_t(image.width) * pieces_x, fine_y = std::int64_t(image.height) * pieces_y;
    const auto first = [](int cell, std::int64_t fine, int cells) { return (cell * fine + cells - 1) / cells; };
    std::array<double, 3> flux{};
    Vec3 moment;
    for (auto y = first(cell_y, fine_y, cells_y); y < first(cell_y + 1, fine_y, cells_y); ++y) {
        const double top = double(y) / pieces_y, bottom = double(y + 1) / pieces_y;
        const double solid_angle = 2 * std::numbers::pi / double(fine_x) *
                                   (std::cos(image.polar_angle(top)) - std::cos(image.polar_angle(bottom)));
        for (auto x = first(cell_x, fine_x, cells_x); x < first(cell_x + 1, fine_x, cells_x); ++x) {
            const float* pixel = image.rgb.data() + 3 * ((y / pieces_y) * image.width + x / pieces_x);
            double luminance = 0;
            for (int c = 0; c < 3; ++c) {
                flux[c] += solid_angle * pixel[c];
                luminance += luminance_weights[c] * pixel[c];
            }
            moment = moment + solid_angle * luminance *
                                  image.direction((double(x) + 0.5) / pieces_x, (double(y) + 0.5) / pieces_y);
        }
    }
    Cell cell{};
    if (!(length(moment) > 0)) return cell;
    const Vec3 d = normalized(moment);
    const ShCoefficients basis = spherical_harmonics(d);
    cell.direction = {float(d.x), float(d.y), float(d.z)};
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < max_coefficients; ++i) cell.light[c * max_coefficients + i] = float(flux[c] * basis[i]);
    return cell;
}

std::vector<Cell> gather(const ProbeImage& image) {
    std::vector<Cell> cells(std::size_t(cells_x) * cells_y);
    parallel_for(cells_y, 1, [&](std::int64_t first, std::int64_t last) {
        for (auto y = first; y < last; ++y)
            for (int x = 0; x < cells_x; ++x) cells[y * cells_x + x] = gather(image, x, int(y));
    });
    return cells;
}

/// Σ light max(0, n·ω), row by row of cells, so that single precision loses nothing.
LambertTable::Entry lambert_at(const std::vector<Cell>& cells, Vec3 normal) {
    const float nx = float(normal.x), ny = float(normal.y), nz = float(normal.z);
    std::array<double, values> sums{};
    for (std::size_t row = 0; row < cells.size(); row += cells_x) {
        std::array<float, values> part{};
        for (std::size_t k = row; k < row + cells_x; ++k) {
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

Vec3 LambertTable::normal(int i, int j) const {
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
    const std::vector<Cell> cells = gather(probe.image);
    return tabulated([&](Vec3 normal) { return lambert_at(cells, normal); });
}

double suitable_stops_of_probe(const Probe::Data& probe) {
    // The mean over all normals is the mean radiance; the largest is looked for some 6 degrees apart, where a cosine is
    // within .2 %.
    constexpr int normals = 33;
    const LambertTable places{normals, {}};
    double mean = 0, largest = 0;
    for (std::size_t c = 0; c < 3; ++c) mean += luminance_weights[c] * probe.sh[c][0] / std::sqrt(4 * std::numbers::pi);
    const std::vector<Cell> cells = gather(probe.image);
    const double y_00 = 1 / std::sqrt(4 * std::numbers::pi);
    for (int j = 0; j < normals; ++j)
        for (int i = 0; i < normals; ++i) {
            const Vec3 n = places.normal(i, j);
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
                           int bands) {
    const Axes grid_from_probe =
        composed(grid_from_world(geometry), world_from_probe(lighting.probe.rotation_deg, orbit_up));
    const Axes probe_from_grid = transposed(grid_from_probe);
    const ShRotation rotation(grid_from_probe);
    const auto factors = window_factors(window, bands);
    const double gain = probe_gain(lighting);
    const Probe probe = lighting_probe(lighting);
    const LambertTable& own = probe.data().lambert();
    return tabulated([&](Vec3 normal) {
        LambertTable::Entry entry = own.at(turned(probe_from_grid, normal));
        for (auto& coefficients : entry) {
            coefficients = rotation(coefficients);
            for (int l = 0; l < max_bands; ++l)
                for (int i = l * l; i < (l + 1) * (l + 1); ++i) coefficients[i] *= float(gain * factors[l]);
        }
        return entry;
    });
}

}  // namespace chiaro
