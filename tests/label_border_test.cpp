// Borders of labels: smooth, and in their place. Truth: analytic balls, tubes and sheets.
#include <chiaro/geometry.h>

#include <cmath>
#include <functional>
#include <queue>
#include <random>

#include <gtest/gtest.h>

#include "classify/labels/border.h"

using namespace chiaro;

namespace {

/// A set of voxels, and the signed distance of its border; cubes of n voxels, n a multiple of the tile's.
struct Field {
    int n;
    std::vector<std::uint8_t> inside;
    std::vector<float> distance;

    Field(int size, const std::function<bool(Vec3)>& is_inside, const Vec3& spacing = {1, 1, 1})
        : n((size + BorderTile::edge - 1) / BorderTile::edge * BorderTile::edge),
          inside(std::size_t(n) * n * n),
          distance(inside.size()) {
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) inside[at(x, y, z)] = is_inside({double(x), double(y), double(z)});
        BorderTile tile(border_widths(spacing));
        std::vector<std::uint8_t> around(std::size_t(tile.row()) * tile.row() * tile.row());
        for (int z = 0; z < n; z += BorderTile::edge)
            for (int y = 0; y < n; y += BorderTile::edge)
                for (int x = 0; x < n; x += BorderTile::edge) fill(tile, around, x, y, z);
    }

    std::size_t at(int x, int y, int z) const {
        const auto within = [&](int i) { return std::size_t(std::clamp(i, 0, n - 1)); };
        return (within(z) * std::size_t(n) + within(y)) * std::size_t(n) + within(x);
    }
    double value(Vec3 p) const {
        return trilinear(p, [&](int x, int y, int z) { return double(distance[at(x, y, z)]); });
    }
    /// Central differences of one voxel, interpolated: what shades.
    Vec3 normal(Vec3 p) const {
        Vec3 g;
        for (int axis = 0; axis < 3; ++axis)
            g[axis] = trilinear(p, [&](int x, int y, int z) {
                std::array<int, 3> d{};
                d[std::size_t(axis)] = 1;
                return 0.5 * (distance[at(x + d[0], y + d[1], z + d[2])] - distance[at(x - d[0], y - d[1], z - d[2])]);
            });
        return normalized(-g);
    }

private:
    void fill(BorderTile& tile, std::vector<std::uint8_t>& around, int x0, int y0, int z0) {
        for (int z = 0, i = 0; z < tile.row(); ++z)
            for (int y = 0; y < tile.row(); ++y)
                for (int x = 0; x < tile.row(); ++x, ++i)
                    around[std::size_t(i)] =
                        inside[at(x0 + x - tile.halo(), y0 + y - tile.halo(), z0 + z - tile.halo())];
        const std::vector<float>& found = tile.distance(around);
        for (int z = 0, i = 0; z < BorderTile::edge; ++z)
            for (int y = 0; y < BorderTile::edge; ++y)
                for (int x = 0; x < BorderTile::edge; ++x, ++i)
                    distance[at(x0 + x, y0 + y, z0 + z)] = found[std::size_t(i)];
    }
    static double trilinear(Vec3 p, const std::function<double(int, int, int)>& voxel) {
        const int x = int(std::floor(p.x)), y = int(std::floor(p.y)), z = int(std::floor(p.z));
        double sum = 0;
        for (int c = 0; c < 8; ++c) {
            const int dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
            sum += (dx ? p.x - x : 1 - p.x + x) * (dy ? p.y - y : 1 - p.y + y) * (dz ? p.z - z : 1 - p.z + z) *
                   voxel(x + dx, y + dy, z + dz);
        }
        return sum;
    }
};

/// Along p + t v from t0, which is outside, to t1: where the distance is 0.
double crossing(const Field& field, Vec3 p, Vec3 v, double t0, double t1) {
    for (int i = 0; i < 30; ++i) {
        const double t = 0.5 * (t0 + t1);
        (field.value(p + t * v) > 0 ? t1 : t0) = t;
    }
    return 0.5 * (t0 + t1);
}

struct BallError {
    double shade, farthest, mean;
};
/// Under a headlight: RMS of shade minus true shade over mean shade; and how far the surface lies off.
BallError error_of(const Field& field, Vec3 centre, double radius) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const Vec3 eye = normalized({0.57, 0.35, 0.74});
    double squares = 0, shades = 0, weights = 0;
    BallError e{};
    int count = 0;
    while (count < 4000) {
        const Vec3 n = normalized({normal(random), normal(random), normal(random)});
        const double t = dot(n, eye);
        if (t < 0.05) continue;
        const double r = crossing(field, centre, n, radius + 1.5, radius - 1.5);
        const double shade = std::abs(dot(field.normal(centre + r * n), eye));
        squares += t * (shade - t) * (shade - t), shades += t * t, weights += t;  // pixels see t of it
        e.farthest = std::max(e.farthest, std::abs(r - radius)), e.mean += r - radius;
        ++count;
    }
    e.mean /= count;
    e.shade = std::sqrt(squares / weights) / (shades / weights);
    return e;
}

/// By samples of a quarter voxel, away from the cube's border.
std::vector<std::uint8_t> finely(const Field& field, int from, int to) {
    const int n = 4 * (to - from);
    std::vector<std::uint8_t> fine(std::size_t(n) * n * n);
    for (int z = 0, i = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x, ++i)
                fine[std::size_t(i)] =
                    field.value({from + (x + 0.5) / 4, from + (y + 0.5) / 4, from + (z + 0.5) / 4}) > 0;
    return fine;
}

int pieces_of(const std::vector<std::uint8_t>& set, int n, std::uint8_t wanted) {
    std::vector<std::uint8_t> seen(set.size());
    int pieces = 0;
    for (std::size_t s = 0; s < set.size(); ++s) {
        if (set[s] != wanted || seen[s]) continue;
        ++pieces;
        std::queue<std::size_t> queue;
        queue.push(s), seen[s] = 1;
        while (!queue.empty()) {
            const auto i = std::int64_t(queue.front());
            queue.pop();
            const std::int64_t p[3] = {i % n, i / n % n, i / n / n}, stride[3] = {1, n, std::int64_t(n) * n};
            for (int axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    if (p[axis] + step < 0 || p[axis] + step >= n) continue;
                    const auto j = std::size_t(i + step * stride[axis]);
                    if (set[j] == wanted && !seen[j]) seen[j] = 1, queue.push(j);
                }
        }
    }
    return pieces;
}

const Vec3 directions[] = {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0.3, 0.1}, {0.1, 1, 0.7}};

}  // namespace

TEST(LabelBorder, BallsAreSmoothAndInTheirPlace) {
    for (const double radius : {10.0, 30.0, 60.0}) {
        const double middle = std::ceil(radius) + 4;
        const Vec3 centre{middle + 0.13, middle - 0.21, middle + 0.37};
        const Field field(int(2 * middle), [&](Vec3 p) { return length(p - centre) <= radius; });
        const BallError e = error_of(field, centre, radius);
        EXPECT_LE(e.shade, 0.02) << radius;  // where memberships that are interpolated have .16
        EXPECT_LE(e.farthest, 0.35) << radius;
        EXPECT_LE(std::abs(3 * e.mean / radius), 0.01) << radius;  // of the volume
    }
}

TEST(LabelBorder, EachVoxelKeepsItsSide) {
    std::mt19937 random(3);
    const Field field(32, [&](Vec3) { return random() % 3 == 0; });  // noise: nothing to smooth
    for (std::size_t i = 0; i < field.inside.size(); ++i) ASSERT_EQ(field.distance[i] > 0, field.inside[i] != 0);
}

TEST(LabelBorder, TubesAndSheetsStayWhole) {
    const Vec3 centre{16.11, 15.77, 16.31};
    for (const double width : {2.0, 3.0})
        for (const int shape : {0, 1, 2, 3})
            for (const Vec3 v : directions) {
                const bool is_tube = shape % 2, is_thick = shape > 1;  // thick: of slices, as many voxels wide
                const Vec3 d = normalized(v);
                const Field field(32,
                                  [&](Vec3 p) {
                                      const Vec3 q = p - centre;
                                      return (is_tube ? length(q - dot(q, d) * d) : std::abs(dot(q, d))) <= width / 2;
                                  },
                                  {1, 1, is_thick ? 5.0 : 1.0});
                const auto fine = finely(field, 4, 28);
                std::size_t voxels = 0, samples = 0;
                for (int z = 4; z < 28; ++z)
                    for (int y = 4; y < 28; ++y)
                        for (int x = 4; x < 28; ++x) voxels += field.inside[field.at(x, y, z)];
                for (const std::uint8_t s : fine) samples += s;
                const std::string what = std::string(is_thick ? "of thick slices: " : "") +
                                         (is_tube ? "tube " : "sheet ") + std::to_string(width) + " along " +
                                         std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z);
                EXPECT_GE(double(samples) / 64, 0.85 * double(voxels)) << what;
                EXPECT_LE(double(samples) / 64, 1.27 * double(voxels)) << what;
                EXPECT_EQ(pieces_of(fine, 96, 1), 1) << what;
                EXPECT_EQ(pieces_of(fine, 96, 0), is_tube ? 1 : 2) << what;
            }
}
