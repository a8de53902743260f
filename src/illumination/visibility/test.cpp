// Visibility in spherical harmonics: closed forms, and brute force.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>

#include "illumination/sh/basis.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/sweep.h"

using namespace chiaro;

namespace {

constexpr double pi = std::numbers::pi;

CellGrid cubic(int nx, int ny, int nz) {
    CellGrid grid;
    grid.count = {nx, ny, nz};
    return grid;
}

template <class Kappa>
Density density_where(const CellGrid& grid, const Kappa& kappa) {
    Density d(grid);
    for (int z = 0; z < grid.count[2]; ++z)
        for (int y = 0; y < grid.count[1]; ++y)
            for (int x = 0; x < grid.count[0]; ++x) d.data()[grid.index(x, y, z)] = float(kappa(x, y, z));
    return d;
}

ShField swept(const Density& density, int directions, double start = 0.5, Device device = Device::cpu()) {
    Progress progress;
    return sweep_visibility(device, density, fibonacci_directions(directions), 16, start, progress);
}

}  // namespace

TEST(Sweep, NothingStopsTheLightOfAnEmptyVolume) {
    const ShField field = swept(density_where(cubic(9, 7, 5), [](int, int, int) { return 0; }), 400);
    for (std::size_t i = 0; i < field.grid.size(); ++i) {
        EXPECT_NEAR(field.node(i)[0], std::sqrt(4 * pi), 1e-5);
        for (int c = 1; c < 16; ++c) EXPECT_NEAR(field.node(i)[c], 0, 0.01);
    }
}

TEST(Sweep, Speed) {
    const int n = 128;
    const Density fog = density_where(cubic(n, n, n), [](int x, int y, int z) {
        return 0.02 + 0.02 * std::sin(0.2 * x) * std::cos(0.17 * y + 0.1 * z);
    });
    const std::clock_t start = std::clock();
    const ShField field = swept(fog, 400);
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("core seconds %g, ns a node and direction %g\n", seconds, seconds * 1e9 / (double(n) * n * n * 400));
}
