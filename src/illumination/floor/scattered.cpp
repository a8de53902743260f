#include "illumination/floor/scattered.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/threads.h"
#include "illumination/probe/light.h"

namespace chiaro {
namespace {

constexpr int coarse_edge = 64, directions = 128;

/// Evenly over the disc under a hemisphere, so that each weighs the same in E/π (Malley): a spiral of golden angles.
std::array<Vec3, directions> upper_hemisphere() {
    std::array<Vec3, directions> all;
    for (int k = 0; k < directions; ++k) {
        const double r = std::sqrt((k + 0.5) / directions), turn = 2.399963229728653 * k;
        all[std::size_t(k)] = {r * std::cos(turn), r * std::sin(turn), std::sqrt(1 - r * r)};
    }
    return all;
}

/// J + 3 m · ω at points of the grid.
class ScatteredRadiance {
public:
    explicit ScatteredRadiance(const TransportNodes& nodes) : nodes_(nodes) {}

    /// `p`: nodes; `d`: unit, in the grid's axes, towards where the light comes from.
    void add(Vec3 p, Vec3 d, double weight, std::array<double, 3>& light) const {
        std::array<int, 3> first;
        std::array<double, 3> t;
        for (int a = 0; a < 3; ++a) {
            const int n = nodes_.grid.count[a];
            const double at = std::clamp(p[a], 0.0, n - 1.0);
            first[a] = std::clamp(int(at), 0, std::max(n - 2, 0));
            t[a] = at - first[a];
        }
        std::array<double, 12> sums{};
        for (int corner = 0; corner < 8; ++corner) {
            double share = 1;
            std::array<int, 3> node = first;
            for (int a = 0; a < 3; ++a) {
                share *= corner >> a & 1 ? t[a] : 1 - t[a];
                node[a] = std::min(first[a] + (corner >> a & 1), nodes_.grid.count[a] - 1);
            }
            const float* from = &nodes_.scattered[12 * nodes_.grid.index(node[0], node[1], node[2])];
            for (std::size_t i = 0; i < 12; ++i) sums[i] += share * from[i];
        }
        for (std::size_t c = 0; c < 3; ++c)
            light[c] +=
                weight * std::max(sums[c] + 3 * (d.x * sums[3 + c] + d.y * sums[6 + c] + d.z * sums[9 + c]), 0.0);
    }

    /// How far from `p` along `d` the grid begins; none where it is missed.
    std::optional<double> entry(Vec3 p, Vec3 d) const {
        double near = 0, far = 1e300;
        for (int a = 0; a < 3; ++a) {
            const double step = std::abs(d[a]) < 1e-12 ? 1e-12 : d[a];
            const double low = (-0.5 - p[a]) / step, high = (nodes_.grid.count[a] - 0.5 - p[a]) / step;
            near = std::max(near, std::min(low, high)), far = std::min(far, std::max(low, high));
        }
        return near < far ? std::optional(near) : std::nullopt;
    }

private:
    const TransportNodes& nodes_;
};

/// Between the coarse points, one channel.
double between(const std::vector<double>& coarse, int channel, double x, double y) {
    const int i = std::min(int(x), coarse_edge - 2), j = std::min(int(y), coarse_edge - 2);
    const double s = x - i, t = y - j;
    const double* at = &coarse[(std::size_t(channel) * coarse_edge + std::size_t(j)) * coarse_edge + std::size_t(i)];
    return (1 - t) * ((1 - s) * at[0] + s * at[1]) + t * ((1 - s) * at[coarse_edge] + s * at[coarse_edge + 1]);
}

}  // namespace

void add_scattered(LitFloor& lit, const TransportNodes& nodes, const Floor& floor, const Geometry& geometry,
                   double factor, int threads) {
    if (nodes.scattered.empty() || !(factor > 0)) return;
    const ScatteredRadiance radiance(nodes);
    const Axes world = Floor::axes(floor.up), grid = grid_from_world(geometry);
    std::array<Vec3, directions> towards = upper_hemisphere(), in_grid;
    std::array<Vec3, directions> per_mm;  // nodes
    for (std::size_t k = 0; k < directions; ++k) {
        const Vec3 direction = turned(world, towards[k]), voxels = geometry.voxel_from_world_vector(direction);
        in_grid[k] = turned(grid, direction);
        for (int a = 0; a < 3; ++a) per_mm[k][a] = voxels[a] / nodes.grid.voxels_per_cell[a];
    }
    constexpr std::size_t points = std::size_t(coarse_edge) * coarse_edge;
    std::vector<double> coarse(3 * points);
    parallel_for(threads, coarse_edge, 1, [&](std::int64_t row, std::int64_t) {
        for (int i = 0; i < coarse_edge; ++i) {
            const auto along = [](double n) { return kernel::FloorView::end * (2 * n / (coarse_edge - 1) - 1); };
            const Vec3 voxel = geometry.voxel_from_world(floor.point(along(i), along(double(row))));
            Vec3 p;
            for (int a = 0; a < 3; ++a) p[a] = (voxel[a] + 0.5) / nodes.grid.voxels_per_cell[a] - 0.5;
            std::array<double, 3> light{};
            for (std::size_t k = 0; k < directions; ++k)
                if (const auto way = radiance.entry(p, per_mm[k]))
                    radiance.add(p + *way * per_mm[k], in_grid[k], factor / directions, light);
            for (std::size_t c = 0; c < 3; ++c)
                coarse[c * points + std::size_t(row) * coarse_edge + std::size_t(i)] = light[c];
        }
    });
    const double per_point = (coarse_edge - 1.0) / (lit.edge - 1);
    for (int c = 0; c < 3; ++c)
        for (int j = 0; j < lit.edge; ++j)
            for (int i = 0; i < lit.edge; ++i)
                lit.light[(std::size_t(c) * std::size_t(lit.edge) + std::size_t(j)) * std::size_t(lit.edge) +
                          std::size_t(i)] += float(between(coarse, c, i * per_point, j * per_point));
}

}  // namespace chiaro
