// Visibility in spherical harmonics by sweeps, as it is kept, and under a light: closed forms and brute force.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "fixtures.h"
#include "illumination/probe/light.h"
#include "illumination/sh/basis.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/lit_nodes.h"
#include "illumination/visibility/sweep.h"
#include "illumination/visibility/visibility.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

constexpr double pi = std::numbers::pi;
using Coefficients = std::array<double, 16>;

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
            for (int x = 0; x < grid.count[0]; ++x) d.numbers()[grid.index(x, y, z)] = float(kappa(x, y, z));
    return d;
}

/// Soft clumps that look different from every side.
Density clumps(int nx, int ny, int nz) {
    return density_where(cubic(nx, ny, nz), [](int x, int y, int z) {
        return 0.12 *
               std::pow(std::max(0.0, std::sin(0.4 * x + 1) * std::cos(0.3 * y) + 0.6 * std::sin(0.35 * z + 0.1 * x)),
                        2);
    });
}

ShField swept(const Density& density, int directions, double start = 0.5, Device device = tested_device(),
              int coefficients = 16, SweepLattice lattice = SweepLattice::grid) {
    Progress progress;
    return sweep_visibility(device, density, fibonacci_directions(directions), coefficients, start, lattice, progress);
}

/// Optical depth from a cube of half edge `start` about a node to the outside, cell by cell.
double depth(const Density& d, std::array<int, 3> at, Vec3 w, double start) {
    double next[3], per_cell[3], way = start / std::max({std::abs(w.x), std::abs(w.y), std::abs(w.z)}), tau = 0;
    for (int a = 0; a < 3; ++a) {
        per_cell[a] = std::abs(w[a]) > 1e-12 ? 1 / std::abs(w[a]) : 1e30;
        next[a] = 0.5 * per_cell[a];
    }
    for (;;) {
        const int a = int(std::min_element(next, next + 3) - next);
        if (next[a] > way) {
            tau += d.data()[d.grid.index(at[0], at[1], at[2])] * (next[a] - way);
            way = next[a];
        }
        at[a] += w[a] < 0 ? -1 : 1;
        if (at[a] < 0 || at[a] >= d.grid.count[a]) return tau;
        next[a] += per_cell[a];
    }
}

Coefficients ground_truth(const Density& d, std::array<int, 3> at, int directions, double start = 0.5) {
    Coefficients sum{};
    for (const Vec3& w : fibonacci_directions(directions)) {
        const double v = std::exp(-depth(d, at, w, start)) * 4 * pi / directions;
        const auto y = spherical_harmonics(w);
        for (int c = 0; c < 16; ++c) sum[c] += v * y[c];
    }
    return sum;
}

/// Relative L2 over random nodes.
double error_of(const ShField& field, const Density& d, int directions, double start = 0.5) {
    std::mt19937 random(7);
    double off = 0, size = 0;
    for (int i = 0; i < 60; ++i) {
        std::array<int, 3> at;
        for (int a = 0; a < 3; ++a) at[a] = int(random() % unsigned(d.grid.count[a]));
        const Coefficients expected = ground_truth(d, at, directions, start);
        const float* found = field.node(d.grid.index(at[0], at[1], at[2]));
        for (int c = 0; c < 16; ++c) {
            off += (found[c] - expected[c]) * (found[c] - expected[c]);
            size += expected[c] * expected[c];
        }
    }
    return std::sqrt(off / size);
}

}  // namespace

TEST(Sweep, NothingStopsTheLightOfAnEmptyVolume) {
    for (SweepLattice lattice : {SweepLattice::grid, SweepLattice::sheared}) {
        const ShField field = swept(density_where(cubic(9, 7, 5), [](int, int, int) { return 0; }), 400, 0.5,
                                    tested_device(), 16, lattice);
        for (std::size_t i = 0; i < field.grid.size(); ++i) {
            EXPECT_NEAR(field.node(i)[0], std::sqrt(4 * pi), 1e-5);
            for (int c = 1; c < 16; ++c) EXPECT_NEAR(field.node(i)[c], 0, 0.01);
        }
    }
}

TEST(Sweep, OnAnOpaqueHalfSpaceHalfOfTheSkyIsSeen) {
    // Along each axis and from both sides; m = 0 about the normal: √π, √(3π)/2, 0, -√(7π)/8.
    for (int axis = 0; axis < 3; ++axis)
        for (int side : {-1, 1}) {
            std::array<int, 3> n{61, 61, 61}, at{30, 30, 30};
            n[axis] = 8, at[axis] = side > 0 ? 4 : 3;
            const Density d = density_where(cubic(n[0], n[1], n[2]), [&](int x, int y, int z) {
                const int k = std::array{x, y, z}[axis];
                return (side > 0 ? k < 4 : k > 3) ? 50.0 : 0.0;
            });
            const ShField field = swept(d, 2000);
            const float* v = field.node(d.grid.index(at[0], at[1], at[2]));
            Vec3 normal{};
            normal[axis] = side;
            const auto y = spherical_harmonics(normal);
            const double expected[] = {std::sqrt(pi), std::sqrt(3 * pi) / 2, 0, -std::sqrt(7 * pi) / 8};
            for (int l = 0; l < 4; ++l)
                for (int c = l * l; c < (l + 1) * (l + 1); ++c)
                    EXPECT_NEAR(v[c], expected[l] * y[c] / std::sqrt((2 * l + 1) / (4 * pi)), 0.06)
                        << axis << side << c;
        }
}

TEST(Sweep, MeetsBruteForceInAFog) {
    const Density d = clumps(34, 29, 25);
    EXPECT_LT(error_of(swept(d, 400), d, 4096), 0.015);
    EXPECT_LT(error_of(swept(d, 400, 0.25), d, 4096, 0.25), 0.015);
    EXPECT_LT(error_of(swept(d, 400, 0.5, tested_device(), 16, SweepLattice::sheared), d, 4096), 0.015);
}

TEST(Sweep, ATurnedVolumeHasATurnedField) {
    // By 90° about z: x → y, y → -x. Directions do not turn with it, so many are taken.
    const int n = 21;
    const Density d = clumps(n, n, n);
    const Density turned_density =
        density_where(d.grid, [&](int x, int y, int z) { return d.data()[d.grid.index(y, n - 1 - x, z)]; });
    const ShField field = swept(d, 4000), turned_field = swept(turned_density, 4000);
    const ShRotation rotate(Axes{{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}});
    for (std::array at : {std::array{10, 10, 10}, {3, 15, 8}, {19, 2, 0}, {0, 0, 20}}) {
        ShCoefficients v;
        std::copy_n(field.node(d.grid.index(at[0], at[1], at[2])), 16, v.begin());
        const ShCoefficients expected = rotate(v);
        const float* found = turned_field.node(d.grid.index(n - 1 - at[1], at[0], at[2]));
        for (int c = 0; c < 16; ++c) EXPECT_NEAR(found[c], expected[c], 0.012) << c;
    }
}

TEST(Sweep, FourCoefficientsAreTheFirstOfSixteen) {
    const Density d = clumps(17, 9, 12);
    const ShField all = swept(d, 100), few = swept(d, 100, 0.5, tested_device(), 4);
    for (std::size_t i = 0; i < d.grid.size(); ++i)
        for (int c = 0; c < 4; ++c) EXPECT_EQ(few.node(i)[c], all.node(i)[c]);
}

TEST(Sweep, GivesTheSameBitsOnEveryInstructionSetAndThreadCount) {
    Density d = clumps(23, 18, 14);
    for (int i = 0; i < 400; ++i)
        d.numbers()[(i * 131) % d.grid.size()] = 30;  // some opaque cells, and what lies behind
    for (SweepLattice lattice : {SweepLattice::grid, SweepLattice::sheared}) {
        const ShField expected = swept(d, 130, 0.25, Device::cpu(1, Isa::scalar), 16, lattice);
        for (Isa isa : available_isas()) {
            if (isa > tested_device().isa) continue;
            for (int threads : {1, 3}) {
                const ShField found = swept(d, 130, 0.25, Device::cpu(threads, isa), 16, lattice);
                EXPECT_EQ(std::memcmp(found.buffer.data(), expected.buffer.data(), expected.buffer.size()), 0)
                    << int(isa) << " " << threads;
            }
        }
    }
}

TEST(Sweep, CanBeCancelled) {
    Progress progress([](std::string_view, double) {});
    progress.cancel();
    EXPECT_THROW(sweep_visibility(tested_device(), clumps(8, 8, 8), fibonacci_directions(40), 16, 0.5,
                                  SweepLattice::grid, progress),
                 Error);
}

TEST(Nodes, HalvesAreTheNearest) {
    using namespace kernel;
    for (int bits = 0; bits < 0x7c00; ++bits) EXPECT_EQ(to_half(from_half(std::uint16_t(bits))), bits);
    EXPECT_EQ(from_half(0x3c00), 1.0f);
    EXPECT_EQ(from_half(0xbc00), -1.0f);
    EXPECT_EQ(from_half(0x0001), 5.9604645e-08f);
    EXPECT_EQ(to_half(1.0f + 0.00049f), 0x3c01);  // just above the tie
    EXPECT_EQ(to_half(1.0f + 0.00048828125f), 0x3c00);
    EXPECT_EQ(to_half(-2.0f), 0xc000);
}

TEST(Nodes, AreKeptWithinHalfAStep) {
    const Density d = clumps(20, 16, 18);
    const ShField field = swept(d, 200);
    Progress progress;
    for (ShStorage storage : {ShStorage::u8, ShStorage::f16, ShStorage::f32}) {
        VisibilitySettings settings{.model = VisibilityModel::paper, .storage = storage};
        const VisibilityNodes nodes = keep_nodes(tested_device(), field, settings, progress);
        for (std::size_t i = 0; i < d.grid.size(); ++i) {
            float kept[16];
            nodes.view().load(std::int64_t(i), kept);
            for (int c = 0; c < 16; ++c) {
                const double allowed = storage == ShStorage::u8    ? coefficient_bounds[c] / 254
                                       : storage == ShStorage::f16 ? 1e-3 * std::abs(field.node(i)[c]) + 1e-7
                                                                   : 0;
                EXPECT_NEAR(kept[c] * nodes.step(c), field.node(i)[c], allowed * 1.0001) << c;
            }
        }
    }
}

/// What pictures keep is added up in 16 bits: sums of floats come to the same but where they lie half way between two
/// steps of 8 bits.
TEST(Nodes, SumsInStepsAreThoseOfFloats) {
    const auto d = std::make_shared<const Density>(clumps(37, 22, 29));
    Progress progress;
    for (const VisibilityTraversal traversal : {VisibilityTraversal::sweep, VisibilityTraversal::sheared})
        for (const int bands : {2, 4}) {
            const VisibilitySettings settings{.bands = bands, .directions = 400, .traversal = traversal};
            StageTimer timer;
            const ShField floats = find_visibility(tested_device(), *d, settings, timer, progress);
            const VisibilityNodes expected = keep_nodes(tested_device(), floats, settings, progress),
                                  found = visibility_nodes(tested_device(), d, settings, timer, progress);
            ASSERT_EQ(found.harmonics.size(), expected.harmonics.size());
            std::size_t others = 0;
            for (std::size_t i = 0; i < found.harmonics.size(); ++i) {
                const int away = std::abs(int(std::int8_t(found.harmonics.data()[i])) -
                                          int(std::int8_t(expected.harmonics.data()[i])));
                ASSERT_LE(away, 1);
                others += std::size_t(away);
            }
            EXPECT_GT(others, 0u);
            EXPECT_LT(double(others), 0.02 * double(found.harmonics.size()));
            for (const int threads : {1, 3})
                for (const Isa isa : available_isas()) {
                    const VisibilityNodes again =
                        visibility_nodes(Device::cpu(threads, isa), d, settings, timer, progress);
                    EXPECT_EQ(std::memcmp(again.harmonics.data(), found.harmonics.data(), found.harmonics.size()), 0);
                }
        }
}

TEST(Nodes, AllLightOfAWhiteProbeArrivesInEmptySpace) {
    const Density d = density_where(cubic(6, 5, 4), [](int, int, int) { return 0; });
    const ShField field = swept(d, 400);
    Progress progress;
    const LitNodes nodes(tested_device(), keep_nodes(tested_device(), field, {}, progress));
    for (double strength : {0.0, 0.5, 1.0}) {
        const Lighting lighting{.strength = strength};
        const auto lit = nodes.light({lighting, {0, 0, 1}, Geometry{}, true});
        for (std::size_t i = 0; i < d.grid.size(); ++i)
            EXPECT_NEAR(to_float(lit->view.light.nodes[4 * i]) * lit->view.light.scale.x, 1, 0.005);
        for (const kernel::Vec3<float> n : {kernel::Vec3<float>{0, 0, 1}, {1, 0, 0}, {-0.6f, 0.48f, 0.64f}}) {
            kernel::SamplePoint<float> sample{{3, 2, 2}, 0};
            sample.surface = {1, sample.p_voxel, n};
            kernel::MetSurface<float> met;
            EXPECT_NEAR(lit->view.incident(sample, kernel::ShadingView{}, true, 0.0f, met).diffuse.x, 1, 0.005);
        }
    }
}

TEST(Nodes, TheLightIsFoundAgainOnlyWhereItChanged) {
    const Density d = clumps(8, 8, 8);
    Progress progress;
    const LitNodes nodes(tested_device(), keep_nodes(tested_device(), swept(d, 100), {}, progress));
    Lighting lighting;
    const auto first = nodes.light({lighting, {0, 0, 1}, Geometry{}, false});
    EXPECT_EQ(nodes.light({lighting, {0, 0, 1}, Geometry{}, false}), first);
    lighting.shininess = 3;  // says nothing of what arrives
    EXPECT_EQ(nodes.light({lighting, {0, 0, 1}, Geometry{}, false}), first);
    lighting.probe.exposure = 1;
    const auto brighter = nodes.light({lighting, {0, 0, 1}, Geometry{}, false});
    EXPECT_NE(brighter, first);
    EXPECT_NEAR(to_float(brighter->view.light.nodes[0]) * brighter->view.light.scale.x,
                2 * to_float(first->view.light.nodes[0]) * first->view.light.scale.x, 1e-3);
}

/// E = ρ under a white probe where nothing but the matter itself is in the way.
TEST(Visibility, AnOpenFlatSurfaceKeepsItsBrightness) {
    const Volume volume =
        chiaro::testing::sampled<std::uint8_t>({40, 40, 40}, [](double, double, double z) { return z < 20 ? 200 : 0; });
    chiaro::testing::Shot shot;
    shot.tf.points = {{99, {0.8, 0.5, 0.25}, 0}, {101, {0.8, 0.5, 0.25}, 1}};
    shot.camera.elevation_deg = 90;
    shot.camera.zoom = 4;
    for (const Mode mode : {Mode::dvr, Mode::iso})
        for (const int subsample : {1, 2})
            for (const Shading shading : {Shading::none, Shading::lambert}) {
                shot.shape.mode = mode;
                if (mode == Mode::iso) shot.shape.iso = {{.value = 100, .color = Rgb{0.8, 0.5, 0.25}}};
                shot.lighting.shading = Shading::none;
                const Frame colors = shot.lit(volume, {});
                shot.lighting.shading = shading;
                const Frame lit =
                    shot.lit(volume, {.method = Method::visibility, .visibility = {.subsample = subsample}});
                const std::size_t centre = 4 * (std::size_t(shot.height / 2) * shot.width + shot.width / 2);
                for (std::size_t c = centre; c < centre + 3; ++c)
                    EXPECT_NEAR(lit.rgba[c] / colors.rgba[c], 1, 0.02)
                        << to_text(mode) << subsample << to_text(shading);
            }
}
