// Transport by iterated sweeps: closed forms of radiative transfer.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "classify/medium.h"
#include "fixtures.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/boundary_cells.h"
#include "illumination/transport/directions.h"
#include "illumination/transport/opaque.h"
#include "illumination/transport/transport.h"
#include "illumination/visibility/sweep.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Opacity by value: v / 255 of a transfer function that is linear in extinction, at most `depth` a voxel.
TransferFunction matter(double depth, Rgb rgb = {1, 1, 1}) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    tf.points = {{0, rgb, 0}, {100, rgb, 0}, {101, rgb, -std::expm1(-depth)}, {255, rgb, -std::expm1(-depth)}};
    return tf;
}

struct Scene3 {
    Device device = tested_device();
    TransferFunction tf = matter(1);
    Shape shape;
    Lighting lighting;
    TransportSettings settings{.grid = 128, .error = 1e-7};
    ScatteringSettings scattering{.albedo_max = 1};

    TransportSolver solver(const Volume& volume) const {
        Progress progress;
        return TransportSolver(device, classify(upload(device, volume), tf, shape).data(), lighting, settings,
                               scattering, {0, 0, 1}, progress);
    }
    TransportNodes solved(const Volume& volume, int iterations) const {
        TransportSolver s = solver(volume);
        Progress progress;
        for (int i = 0; i < iterations && s.iterate(progress); ++i) {
        }
        return s.nodes();
    }
};

Volume filled(std::array<int, 3> n, const Field& f) { return sampled<std::uint8_t>(n, f); }
double at(const TransportNodes& nodes, int x, int y, int z, int c = 0) {
    return nodes.light[3 * nodes.grid.index(x, y, z) + c];
}

}  // namespace

TEST(TransportDirections, TurnedSetsIntegrateSmoothFunctions) {
    for (int index : {0, 1, 7}) {
        const auto set = turned_directions(24, index, 3);
        ASSERT_EQ(set.size(), 24u);
        double x = 0, xx = 0, x4 = 0, x6 = 0;
        for (Vec3 d : set)
            x += d.x / 24, xx += d.x * d.x / 24, x4 += std::pow(d.x, 4) / 24, x6 += std::pow(d.x, 6) / 24;
        EXPECT_NEAR(x, 0, 1e-12);
        EXPECT_NEAR(xx, 1.0 / 3, 1e-12);
        EXPECT_NEAR(x4, 1.0 / 5, 1e-4);
        EXPECT_NEAR(x6, 1.0 / 7, 1e-3);
    }
}

TEST(Transport, AnEmptyVolumeHoldsTheProbesLight) {
    const TransportNodes nodes = Scene3().solved(filled({20, 17, 9}, [](double, double, double) { return 0; }), 2);
    for (float j : nodes.light) EXPECT_NEAR(j, 1, 1e-5);
    for (float m : nodes.moment) EXPECT_NEAR(m, 0, 0.01);
}

TEST(Transport, AFurnaceIsInvisible) {
    // Light not yet scattered and scattered light come in different directions, so that what is missing of the one is
    // found in the other but for the noise of 24 directions.
    for (double depth : {0.05, 0.5, 2.0, 30.0}) {
        Scene3 scene{.tf = matter(depth)};
        const Volume ball = filled({24, 24, 24}, [](double x, double y, double z) {
            return std::hypot(x - 11.5, y - 11.5, z - 11.5) < (9) ? 200 : 0;
        });
        const TransportNodes nodes = scene.solved(ball, 64);
        double worst = 0, sum = 0, count = 0;
        for (std::size_t n = 0; n < nodes.grid.size(); ++n) {
            if (depth > 1 && nodes.weight[n] > 0.5) continue;  // within matter many iterations more are needed
            worst = std::max(worst, std::abs(nodes.light[3 * n] - 1.0));
            sum += nodes.light[3 * n], count += 1;
        }
        EXPECT_LT(worst, 0.04) << depth << " after " << nodes.iterations;
        EXPECT_NEAR(sum / count, 1, 0.004) << depth;
    }
}

TEST(Transport, AHalfSpaceReflectsItsShare) {
    // Just above it: ½ (1 + mean radiance of what comes back). Of cells that are followed one by one that is the mean
    // of 1 - s H(μ) over the hemisphere (Chandrasekhar), (1 - s) / (1 + s), s = √(1 - a); opaque ones send back R alike
    // in all directions.
    for (double a : {0.5, 0.9})
        for (double depth : {0.2, 0.5, 30.0}) {
            Scene3 scene{.tf = matter(depth, {a, a, a})};
            const Volume half = filled({72, 72, 40}, [](double, double, double z) { return z < 36 ? 200 : 0; });
            const TransportNodes nodes = scene.solved(half, 30);
            const double s = std::sqrt(1 - a), back = depth < 4 ? (1 - s) / (1 + s) : half_space_reflectance(a);
            EXPECT_NEAR(at(nodes, 36, 36, 36), (1 + back) / 2 + 0.007 * (1 - back), 0.02 * (1 + back) / 2)
                << a << ", " << depth;  // .007: what is seen past the edges
        }
}

TEST(Transport, ThickCellsFollowedOneByOneReflectTheSame) {
    Scene3 scene{.tf = matter(30, {0.5, 0.5, 0.5}), .scattering = {.bounces = {30}, .albedo_max = 1}};
    const Volume half = filled({72, 72, 40}, [](double, double, double z) { return z < 36 ? 200 : 0; });
    const double back = half_space_reflectance(0.5);  // of two streams along the normal alone (1 - s) / (1 + s), .17
    EXPECT_NEAR(at(scene.solved(half, 30), 36, 36, 36), (1 + back) / 2 + 0.007 * (1 - back), 0.02 * (1 + back) / 2);
}

TEST(Transport, LightThroughASlabOfAbsorbersFallsAsE2) {
    // Black matter: half of E_2(κ z) from each side (flux-free mean: ½ E_2 of radiance 1 over a hemisphere).
    Scene3 scene{.tf = matter(0.1, {0, 0, 0}), .settings = {.grid = 128, .first_directions = 800}};
    const TransportNodes nodes = scene.solved(filled({120, 120, 20}, [](double, double, double) { return 200; }), 2);
    const auto e2 = [](double x) {
        double sum = 0;
        for (int i = 0; i < 4000; ++i) {
            const double mu = (i + 0.5) / 4000;
            sum += std::exp(-x / mu) / 4000;
        }
        return sum;
    };
    for (int z : {5, 10}) {
        const double depth = 0.1 * (z + 0.5), other = 0.1 * (19.5 - z);
        EXPECT_NEAR(at(nodes, 60, 60, z), (e2(depth) + e2(other)) / 2, 0.012) << z;
    }
}

TEST(Transport, ClosedWallsOfOneCellLetNothingThrough) {
    for (int wall : {1, 2, 3}) {
        Scene3 scene{.tf = matter(40, {0.95, 0.95, 0.95})};
        const Volume box = filled({32, 32, 32}, [&](double x, double y, double z) {
            const double r = std::max({std::abs(x - 15.5), std::abs(y - 15.5), std::abs(z - 15.5)});
            return r > 10 && r < 10 + wall ? 200 : 0;
        });
        const TransportNodes nodes = scene.solved(box, 30);
        for (int z = 7; z < 25; z += 4) EXPECT_LT(at(nodes, 15, 12, z), 3e-4) << wall << ", " << z;
        if (wall == 3) EXPECT_LT(at(nodes, 15, 15, 27), 3e-4);  // its middle, which pictures may read from within
        EXPECT_GT(at(nodes, 15, 15, 30), 0.7);
    }
}

TEST(Transport, OpaqueMatterHoldsWhatItsOpenSideSees) {
    Scene3 scene{.tf = matter(40, {0.8, 0.8, 0.8})};
    const TransportNodes nodes =
        scene.solved(filled({60, 60, 30}, [](double, double, double z) { return z < 20 ? 200 : 0; }), 12);
    const double seen = half_space_reflectance(0.8) / 0.8;
    EXPECT_NEAR(at(nodes, 30, 30, 19), seen, 0.02 * seen);
    EXPECT_NEAR(at(nodes, 30, 30, 18), seen, 0.02 * seen);  // between the two a sample finds the same
    EXPECT_GT(nodes.moment[9 * nodes.grid.index(30, 30, 19) + 2], 0.1);
}

TEST(Transport, MoreBouncesAreBrighterUpToTheConvergedLight) {
    Scene3 scene{.tf = matter(0.3, {0.9, 0.9, 0.9})};
    const Volume ball = filled({24, 24, 24}, [](double x, double y, double z) {
        return std::hypot(x - 11.5, y - 11.5, z - 11.5) < 9 ? 200 : 0;
    });
    double before = 0;
    for (int bounces : {0, 1, 2, 5, 40}) {
        scene.scattering.bounces.most = bounces;
        const double j = at(scene.solved(ball, 100), 12, 12, 12);
        EXPECT_GT(j, before) << bounces;
        before = j;
    }
    scene.scattering.bounces.most.reset();
    EXPECT_NEAR(at(scene.solved(ball, 40), 12, 12, 12), before, 0.02);
}

TEST(Transport, IsTheSameForAnyNumberOfThreadsAndEveryInstructionSet) {
    Scene3 scene{.tf = matter(1, {0.9, 0.6, 0.3})};
    const Volume lumps = filled({37, 22, 29}, [](double x, double y, double z) {
        return 90 + 60 * std::sin(0.5 * x) * std::cos(0.4 * y + 0.2 * z);
    });
    scene.lighting.loaded_probe = builtin_probe("studio");
    scene.device = Device::cpu(1, Isa::scalar);
    const TransportNodes expected = scene.solved(lumps, 3);
    for (Isa isa : available_isas())
        for (int threads : {1, 3}) {
            scene.device = Device::cpu(threads, isa);
            const TransportNodes found = scene.solved(lumps, 3);
            EXPECT_EQ(found.light, expected.light) << name_of(isa) << ", " << threads;
            EXPECT_EQ(found.moment, expected.moment);
            EXPECT_EQ(found.change, expected.change);
        }
}

TEST(Transport, ASunCastsASharpShadow) {
    std::vector<float> rgb(3 * 64 * 128, 0.0f);  // straight above: the first row of pixels
    for (int x = 0; x < 3 * 128; ++x) rgb[std::size_t(x)] = 1000;
    Scene3 scene{.tf = matter(40, {0.5, 0.5, 0.5})};
    scene.lighting.loaded_probe = Probe(128, 64, rgb);
    const Volume plate = filled({40, 40, 40}, [](double x, double y, double z) {
        return z >= 30 && z < 32 && std::abs(x - 19.5) < 8 && std::abs(y - 19.5) < 8 ? 200 : 0;
    });
    const TransportNodes nodes = scene.solved(plate, 6);
    const double open = at(nodes, 2, 20, 10);
    EXPECT_LT(at(nodes, 20, 20, 10), 0.02 * open);
    EXPECT_LT(at(nodes, 13, 20, 10), 0.05 * open);
    EXPECT_GT(at(nodes, 10, 20, 10), 0.95 * open);
    EXPECT_NEAR(nodes.moment[9 * nodes.grid.index(2, 20, 10) + 2], open, 0.05 * open);
}

TEST(Transport, ClippedMatterCastsNoShadow) {
    Scene3 scene{.tf = matter(40, {0.5, 0.5, 0.5})};
    const Volume block = filled({24, 24, 24}, [](double, double, double z) { return z < 12 ? 200 : 0; });
    scene.shape.clip.planes = {{{1, 0, 0}, 11.5}};
    const TransportNodes nodes = scene.solved(block, 8);
    EXPECT_GT(at(nodes, 20, 12, 4), 0.55);
    EXPECT_LT(at(nodes, 5, 12, 4), 0.01);
    scene.shape = {.threshold_low = 210};
    for (float j : scene.solved(block, 2).light) EXPECT_NEAR(j, 1, 1e-4);
}

TEST(Transport, StopsWhenAsked) {
    Scene3 scene;
    const Volume block = filled({64, 64, 64}, [](double, double, double) { return 200; });
    TransportSolver solver = scene.solver(block);
    Progress progress;
    ASSERT_TRUE(solver.iterate(progress));
    const TransportNodes before = solver.nodes();
    progress.cancel();
    EXPECT_THROW(solver.iterate(progress), Error);
    EXPECT_EQ(solver.nodes().light, before.light);
}

TEST(Transport, RefinesFromCoarseToFineAndStartsFromTheLast) {
    Scene3 scene{.tf = matter(0.3, {0.8, 0.8, 0.8})};
    scene.settings = {.grid = 32, .error = 0.01};
    const Volume block = filled({48, 48, 48}, [](double x, double, double) { return x > 20 ? 200 : 0; });
    const Medium medium = classify(upload(scene.device, block), scene.tf, Shape{});
    TransportMemory memory;
    int fields[2]{};
    for (int& count : fields) {
        StageTimer timer;
        Progress progress;
        bool last_is_coarse = true;
        refine_transport(
            scene.device, medium.data(), scene.lighting, scene.settings, scene.scattering, SurfaceModel::none,
            {0, 0, 1},
            [&](TransportNodes nodes, bool is_coarse) {
                if (count++ == 0) {  // with detail from the last light, where there was any
                    EXPECT_EQ(nodes.grid.count[0], fields[1] == 0 ? 12 : 24);
                }
                last_is_coarse = is_coarse;
            },
            timer, progress, &memory);
        EXPECT_FALSE(last_is_coarse);
        ASSERT_TRUE(memory.fine);
    }
    EXPECT_LE(fields[1], fields[0]);
}

/// Walls and fog that are alike from no side, in an uneven light.
TEST(Transport, TurnedVolumesHoldTheSameLight) {
    const auto matter_at = [](double x, double y, double z) {
        if (x < 3 || (z < 2 && y > 4)) return 230;  // opaque
        return std::hypot(x - 14, y - 9, z - 12) < 5 ? 130 : 0;
    };
    constexpr int n = 24;
    Scene3 scene;
    scene.tf.points = {
        {99, {0.8, 0.5, 0.3}, 0}, {100, {0.8, 0.5, 0.3}, 0.3}, {200, {0.8, 0.5, 0.3}, 0.3}, {201, {0.8, 0.5, 0.3}, 1}};
    scene.settings.first_directions = 400;
    const TransportNodes nodes = scene.solved(filled({n, n, n}, matter_at), 16);
    const auto turned = [&](int axis) {  // by 90 degrees: the other two axes, u and v, become v and -u
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto before = [=](std::array<int, 3> p) {
            std::array<int, 3> q = p;
            q[u] = p[v], q[v] = n - 1 - p[u];
            return q;
        };
        const TransportNodes found = scene.solved(filled({n, n, n},
                                                         [&](double x, double y, double z) {
                                                             const auto q = before({int(x), int(y), int(z)});
                                                             return matter_at(q[0], q[1], q[2]);
                                                         }),
                                                  16);
        double errors = 0, squares = 0, moments = 0;
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const auto q = before({x, y, z});
                    const std::size_t here = found.grid.index(x, y, z), there = nodes.grid.index(q[0], q[1], q[2]);
                    for (int c = 0; c < 3; ++c) {
                        errors += std::pow(found.light[3 * here + c] - nodes.light[3 * there + c], 2);
                        squares += std::pow(nodes.light[3 * there + c], 2);
                        moments +=
                            std::pow(found.moment[9 * here + 3 * c + v] - nodes.moment[9 * there + 3 * c + u], 2);
                    }
                }
        return std::pair(std::sqrt(errors / squares), std::sqrt(moments / squares));
    };
    for (int axis : {0, 1, 2}) {
        const auto [light, moment] = turned(axis);
        EXPECT_LT(light, 0.01) << axis;
        EXPECT_LT(moment, 0.01) << axis;
    }
}

TEST(Transport, BlackMatterLeavesWhatVisibilityFinds) {
    Scene3 scene{.tf = matter(0.4, {0, 0, 0})};
    scene.settings.first_directions = 300;
    const Volume ball = filled({24, 24, 24}, [](double x, double y, double z) {
        return std::hypot(x - 11.5, y - 11.5, z - 11.5) < 8 ? 200 : 0;
    });
    const TransportNodes nodes = scene.solved(ball, 2);
    Progress progress;
    const Medium medium = classify(upload(scene.device, ball), scene.tf, scene.shape);
    const Density density = density_for(medium.data(), 1, scene.device, progress);
    const ShField visible =
        sweep_visibility(scene.device, density, fibonacci_directions(300), 4, 0.5, SweepLattice::grid, progress);
    double most = 0;
    for (std::size_t node = 0; node < nodes.grid.size(); ++node) {
        if (nodes.weight[node] > 0.01) continue;  // within matter J is a mean over the cell, V begins at its border
        most =
            std::max(most, std::abs(nodes.light[3 * node] - visible.node(node)[0] / std::sqrt(4 * std::numbers::pi)));
    }
    EXPECT_LT(most, 0.03);
}

TEST(Transport, AnIsosurfaceReflectsItsAlbedo) {
    Scene3 scene{.scattering = {.albedo_max = 0.8}};
    scene.shape.mode = Mode::iso;
    scene.shape.iso = {{.value = 100, .color = Rgb{1, 1, 1}}};
    const Volume half = filled({72, 72, 40}, [](double, double, double z) { return z < 20 ? 200 : 0; });
    EXPECT_NEAR(at(scene.solved(half, 30), 36, 36, 21), (1 + 0.8) / 2, 0.02);
}

/// Walls of three voxels are one and a half cells; their faces are where they are, to half a cell.
TEST(Transport, WallsBeginWithinHalfACellOfTheirFace) {
    Scene3 scene{.tf = matter(40, {0.8, 0.8, 0.8})};
    scene.settings.grid = 16;
    for (int wall : {3, 4, 5}) {
        const Volume volume = filled({32, 32, 32}, [&](double x, double, double) { return x < wall ? 200 : 0; });
        const TransportNodes nodes = scene.solved(volume, 8);
        const double surface = wall - 0.5;  // half way between values of 200 and 0
        for (int x = 0; x < 4; ++x) {
            const double middle = nodes.grid.voxel_of(x, 8, 8).x;
            EXPECT_EQ(nodes.weight[nodes.grid.index(x, 8, 8)] > 0.86f, middle < surface) << wall << ' ' << x;
        }
    }
}

TEST(Transport, SlantedWallsOfACellStayClosed) {
    for (const double slant : {0.0, 0.4, 1.0}) {  // a cell and a quarter thick
        Scene3 scene{.tf = matter(40, {0.95, 0.95, 0.95})};
        scene.settings.grid = 24;
        const Volume box = filled({48, 48, 48}, [&](double x, double y, double z) {
            const double a = x - 23.5 + slant * (y - 23.5), b = y - 23.5 - slant * (x - 23.5);
            const double r = std::max({std::abs(a), std::abs(b)}) / std::hypot(1, slant);
            const double side = std::max(r, std::abs(z - 23.5));
            return side > 12 && side < 14.5 ? 200 : 0;
        });
        EXPECT_LT(at(scene.solved(box, 20), 12, 12, 12), 6e-3) << slant;
    }
}
