// Rays against closed forms, against a plain traversal written here, and against themselves.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <numbers>
#include <random>
#include <thread>

#include "fixtures.h"
#include "illumination/reference/outward.h"
#include "illumination/reference/reference.h"
#include "illumination/sh/directions.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Everything that rays depend on, and what they find.
struct Rays {
    TransferFunction tf = constant(0);
    Shape shape = {};
    ReferenceSettings settings = {};
    Device device = tested_device();
    double step = reference_step;
    std::vector<std::array<int, 3>> only = {};  ///< of the blocks; empty: all

    CellValues operator()(const Volume& volume) const {
        Progress progress;
        StageTimer timer;
        const Medium medium = classify(upload(device, volume), tf, shape);
        const CellOpacity opacity = cell_opacity(medium.data(), progress);
        BlockMap blocks(opacity.values.grid.count, only.empty());
        for (const auto& [x, y, z] : only) blocks(x, y, z) = 1;
        return reference_accessibility(device, medium.data(), opacity, settings, blocks, timer, progress, step);
    }
};

double at(const CellValues& v, int x, int y, int z) { return v.data()[v.grid.index(x, y, z)] / double(cell_one); }

double rmse(const CellValues& a, const CellValues& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.grid.size(); ++i) sum += std::pow((a.data()[i] - b.data()[i]) / cell_one, 2);
    return std::sqrt(sum / double(a.grid.size()));
}

bool same(const CellValues& a, const CellValues& b) {
    return std::memcmp(a.data(), b.data(), a.grid.size() * sizeof(std::uint16_t)) == 0;
}

/// Opacity = value / 255.
TransferFunction ramp() {
    TransferFunction tf;
    tf.points = {{0, {1, 1, 1}, 0}, {255, {1, 1, 1}, 1}};
    return tf;
}

Volume blobs(std::array<int, 3> n, int seed) {
    std::mt19937 random{std::uint32_t(seed)};
    std::uniform_int_distribution<int> value(-300, 255);
    return sampled<std::uint8_t>(n, [&](double, double, double) { return std::max(0, value(random)); });
}

/// ∫ exp(-x / μ) dμ over [0, 1]
double exponential_integral_2(double x) {
    double sum = 0;
    for (int i = 0; i < 100000; ++i) sum += std::exp(-x * 100000 / (i + 0.5));
    return sum / 100000;
}

/// One ray by the book (Amanatides and Woo): κ per edge of cell (x, y, z), in double precision.
double marched(const std::function<double(int, int, int)>& kappa, const std::array<int, 3>& n, std::array<int, 3> cell,
               Vec3 d) {
    std::array<double, 3> next;
    for (int a = 0; a < 3; ++a) next[a] = 0.5 / std::abs(d[a]);
    double t = 0, depth = 0;
    for (bool own = true;; own = false) {
        const int a = int(std::min_element(next.begin(), next.end()) - next.begin());
        if (!own) depth += (next[a] - t) * kappa(cell[0], cell[1], cell[2]);
        t = next[a], next[a] += 1 / std::abs(d[a]);
        cell[a] += d[a] < 0 ? -1 : 1;
        if (cell[a] < 0 || cell[a] >= n[a]) return std::exp(-depth);
    }
}

}  // namespace

TEST(Reference, EmptyIsOpen) {
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        const CellValues open = Rays{.settings = {.rays = 16, .medium = medium}}(blobs({5, 33, 4}, 1));
        for (std::size_t i = 0; i < open.grid.size(); ++i) ASSERT_EQ(open.data()[i], 65535) << i;
    }
}

TEST(Reference, EqualsRaysByTheBook) {
    const std::array n{19, 7, 34};
    const Volume volume = blobs(n, 2);
    const auto kappa = [&](int x, int y, int z) {
        return -std::log1p(
            -std::min(volume.as<std::uint8_t>()[std::size_t((z * n[1] + y) * n[0] + x)] / 255.0, 1 - 1e-7));
    };
    const auto directions = fibonacci_directions(64);
    for (auto quantity : {ReferenceQuantity::obscurance, ReferenceQuantity::ao, ReferenceQuantity::ao_cosine}) {
        const Rays rays{.tf = ramp(), .settings = {.rays = 64, .quantity = quantity}};
        const CellValues found = rays(volume);
        Progress progress;
        const CellOpacity opacity = cell_opacity(classify(upload(rays.device, volume), rays.tf, {}).data(), progress);
        for (std::array cell : {std::array{0, 0, 0}, {18, 6, 33}, {9, 3, 17}, {16, 2, 32}, {15, 6, 31}, {3, 0, 20}}) {
            const Outward outward = outward_at(opacity.values, cell[0], cell[1], cell[2], reference_normal_factor);
            double light = 0, weight = 0;
            for (const Vec3& d : directions) {
                const double cosine = dot(outward.normal, d), q = outward.share;
                const double w = quantity == ReferenceQuantity::obscurance ? 1
                                 : quantity == ReferenceQuantity::ao       ? (1 - q) / 2 + q * (cosine > 0)
                                                                           : (1 - q) / 4 + q * std::max(cosine, 0.0);
                light += w * marched(kappa, n, cell, d), weight += w;
            }
            EXPECT_NEAR(at(found, cell[0], cell[1], cell[2]), light / weight, 1.5 / 65535) << cell[0] << int(quantity);
        }
    }
}

TEST(Reference, CentreOfAHomogeneousBall) {
    const double radius = 24, alpha = 0.05;
    for (int thickness : {1, 3}) {  // of a voxel along z, in mm
        const int nz = 63 / thickness;
        Volume ball = sampled<float>({63, 63, nz}, [&](double x, double y, double z) {
            const double r = std::hypot(x - 31, y - 31, thickness * (z - (nz - 1) / 2));
            return std::clamp(radius - r + 0.5, 0.0, 1.0) * 255 * alpha;
        });
        ball.geometry.spacing_mm = {1, 1, double(thickness)};
        for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
            const Rays rays{.tf = ramp(),
                            .settings = {.rays = 1024, .medium = medium, .start_half_voxels = 0, .subsample = 31}};
            EXPECT_NEAR(at(rays(ball), 31, 31, 31), std::pow(1 - alpha, radius), 0.003) << thickness << int(medium);
        }
    }
}

TEST(Reference, MidPlaneOfASlab) {
    const Volume slab = sampled<std::uint8_t>({251, 251, 21}, [](double, double, double) { return 100; });
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear})
        for (double depth : {0.3, 1.0, 2.0}) {  // κ a of half the thickness
            if (medium == ReferenceMedium::trilinear && depth != 1) continue;
            const Rays rays{.tf = constant(-std::expm1(-depth / 10.5)),
                            .settings = {.rays = 1024, .medium = medium, .start_half_voxels = 0, .subsample = 10}};
            EXPECT_NEAR(at(rays(slab), 130, 130, 10), exponential_integral_2(depth), 0.0015) << depth << int(medium);
        }
}

TEST(Reference, OnAnOpaqueHalfSpace) {
    const Volume ground =
        sampled<std::uint8_t>({257, 257, 9}, [](double, double, double z) { return z < 4 ? 255 : 0; });
    Rays rays{.tf = ramp(), .settings = {.rays = 1024}, .only = {{4, 4, 0}}};
    EXPECT_NEAR(at(rays(ground), 128, 128, 4), 0.5, 0.004);
    // Those that leave the surface's own cell upwards, and a few through a corner of the next cell.
    EXPECT_NEAR(at(rays(ground), 128, 128, 3), 1 / 6.0, 0.02);
    rays.settings.quantity = ReferenceQuantity::ao;
    EXPECT_EQ(at(rays(ground), 128, 128, 4), 1);
    rays.settings.quantity = ReferenceQuantity::ao_cosine;
    EXPECT_EQ(at(rays(ground), 128, 128, 4), 1);
}

/// What a cube of one edge and the highest opacity, 1 - 1e-7, keeps from a point at a distance of whole edges.
double taken_by_a_cube(int x, int y, int z) {
    const double kappa = -std::log(1e-7);
    double taken = 0;
    for (const Vec3& d : fibonacci_directions(100000)) {
        double in = 0, out = 1e9;
        for (auto [p, slope] : {std::pair{x, d.x}, {y, d.y}, {z, d.z}}) {
            const double a = (-0.5 - p) / slope, b = (0.5 - p) / slope;
            in = std::max(in, std::min(a, b)), out = std::min(out, std::max(a, b));
        }
        if (in < out) taken += -std::expm1(-kappa * (out - in));
    }
    return taken / 1e5;
}

TEST(Reference, OneOpaqueCellTakesItsSolidAngle) {
    const Volume volume = sampled<std::uint8_t>(
        {9, 9, 9}, [](double x, double y, double z) { return x == 4 && y == 4 && z == 4 ? 255 : 0; });
    const CellValues found = Rays{.tf = ramp(), .settings = {.rays = 4096}}(volume);
    EXPECT_EQ(at(found, 4, 4, 4), 1);                // nothing occludes itself
    EXPECT_NEAR(at(found, 5, 4, 4), 5 / 6.0, 0.02);  // one face of six, but for its rim
    for (std::array d : {std::array{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}, {3, 1, 0}, {-2, -3, 1}})
        EXPECT_NEAR(1 - at(found, 4 + d[0], 4 + d[1], 4 + d[2]), taken_by_a_cube(d[0], d[1], d[2]), 1e-3) << d[0];
}

TEST(Reference, TurnsWithTheVolume) {
    const auto f = [](double x, double y, double z) {
        return std::fmod(7 * x + 3 * y * y + 5 * z, 11) < 3 ? 90 + 10 * x : 0;
    };
    const int n = 14;
    const Rays rays{.tf = ramp(), .settings = {.rays = 1024}};
    const CellValues straight = rays(sampled<std::uint8_t>({n, n, n}, f));
    const CellValues turned =
        rays(sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) { return f(y, n - 1 - x, z); }));
    const CellValues tipped =
        rays(sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) { return f(x, z, n - 1 - y); }));
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                EXPECT_NEAR(at(straight, y, n - 1 - x, z), at(turned, x, y, z), 0.02);
                EXPECT_NEAR(at(straight, x, z, n - 1 - y), at(tipped, x, y, z), 0.02);
            }
}

TEST(Reference, ThreadsAndInstructionSetsGiveTheSameBits) {
    const Volume volume = blobs({37, 40, 21}, 3);
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear})
        for (auto quantity : {ReferenceQuantity::obscurance, ReferenceQuantity::ao_cosine}) {
            Rays rays{.tf = ramp(), .settings = {.rays = 12, .quantity = quantity, .medium = medium, .subsample = 1}};
            rays.device = Device::cpu(1, Isa::scalar);
            const CellValues scalar = rays(volume);
            for (Isa isa : available_isas()) {
                rays.device = Device::cpu(3, isa);
                EXPECT_TRUE(same(scalar, rays(volume))) << name_of(isa) << int(medium) << int(quantity);
            }
        }
}

TEST(Reference, ConvergesWithTheRays) {
    const Volume volume =
        sampled<std::uint8_t>({24, 24, 24}, [](double x, double y, double z) { return shells(x, y, z, 24); });
    Rays rays{.tf = two_materials()};
    const auto with = [&](int n) { return rays.settings.rays = n, rays(volume); };
    const CellValues ground_truth = with(8192);
    const double coarse = rmse(with(256), ground_truth), fine = rmse(with(1024), ground_truth);
    EXPECT_LT(coarse, 0.004);
    EXPECT_LT(fine, coarse / 2);
    RecordProperty("rmse_256", std::to_string(coarse));
    RecordProperty("rmse_1024", std::to_string(fine));
}

TEST(Reference, InterpolatedFogIsTheSameFog) {
    const Volume fog = make_sample("fog", 32);
    Rays rays{.tf = sample_transfer_function("fog"), .settings = {.rays = 64}};
    const CellValues cells = rays(fog);
    rays.settings.medium = ReferenceMedium::trilinear;
    const CellValues between = rays(fog);
    EXPECT_LT(rmse(cells, between), 0.004);
    rays.step = reference_step / 8;
    EXPECT_LT(rmse(rays(fog), between), 2e-4);  // a step of a quarter edge is fine enough
}

TEST(Reference, WhatIsCutAwayCastsNoShadow) {
    const Volume solid =
        sampled<std::uint8_t>({20, 20, 20}, [](double x, double, double) { return x < 10 ? 200 : 50; });
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        Rays rays{.tf = ramp(), .settings = {.rays = 64, .medium = medium}};
        rays.shape.clip.box = {0.6, 1.0, 0.0, 1.0, 0.0, 1.0};
        const CellValues clipped = rays(solid);
        rays.shape = {.threshold_low = 20, .threshold_high = 100};
        const CellValues cut = rays(solid);
        rays.shape = {};
        const CellValues whole = rays(solid);
        // Half of what a cell near the cut sees is open; without a cut all is dark.
        EXPECT_GT(at(clipped, 12, 10, 10), 0.35) << int(medium);
        EXPECT_GT(at(cut, 10, 10, 10), 0.35) << int(medium);
        EXPECT_LT(at(whole, 10, 10, 10), 0.3) << int(medium);
    }
}

TEST(Reference, SurfacesOcclude) {
    const Volume ground = sampled<float>({129, 129, 12}, [](double, double, double z) { return 100 - 20 * (z - 5.5); });
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        Rays rays{.settings = {.rays = 256, .medium = medium, .subsample = 2}, .only = {{2, 2, 0}}};
        rays.shape.mode = Mode::iso;
        rays.shape.iso = {{100}};  // between cells 5 and 6
        EXPECT_NEAR(at(rays(ground), 64, 64, 6), 0.5, 0.01) << int(medium);
        EXPECT_LT(at(rays(ground), 64, 64, 2), 1e-4) << int(medium);
        rays.settings.quantity = ReferenceQuantity::ao;
        EXPECT_NEAR(at(rays(ground), 64, 64, 6), 1, 0.01) << int(medium);
        rays.shape.iso[0].opacity = 0.25;
        EXPECT_GT(at(rays(ground), 64, 64, 2), 0.01) << int(medium);
    }
}

TEST(Reference, SubsamplingTracesEveryNthCellAndTheLast) {
    const Volume volume =
        sampled<std::uint8_t>({40, 23, 31}, [](double x, double y, double z) { return shells(x, y, z, 31); });
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        Rays rays{.tf = two_materials(), .settings = {.rays = 32, .quantity = ReferenceQuantity::ao, .medium = medium}};
        const CellValues all = rays(volume);
        for (int n : {2, 3, 5, 64}) {
            rays.settings.subsample = n;
            const CellValues some = rays(volume);
            for (int z = 0; z < 31; z = z < 30 ? std::min(z + n, 30) : 31)
                for (int y = 0; y < 23; y = y < 22 ? std::min(y + n, 22) : 23)
                    for (int x = 0; x < 40; x = x < 39 ? std::min(x + n, 39) : 40)
                        ASSERT_EQ(at(some, x, y, z), at(all, x, y, z)) << n << ": " << x << " " << y << " " << z;
            if (n == 2) {
                EXPECT_NEAR(at(some, 21, 8, 8), (at(all, 20, 8, 8) + at(all, 22, 8, 8)) / 2, 2e-5);
                EXPECT_LT(rmse(some, all), 0.06);
            }
        }
    }
}

TEST(Reference, StopsWhenCancelled) {
    using namespace std::chrono;
    const Device device = tested_device();
    const Medium medium = classify(upload(device, blobs({64, 64, 64}, 4)), ramp(), {});
    Progress progress;
    const CellOpacity opacity = cell_opacity(medium.data(), progress);
    const BlockMap blocks(opacity.values.grid.count, true);
    steady_clock::time_point asked;
    std::jthread canceller([&] {
        std::this_thread::sleep_for(200ms);
        asked = steady_clock::now();
        progress.cancel();
    });
    StageTimer timer;
    const ReferenceSettings endless{.rays = 65536};
    EXPECT_THROW(reference_accessibility(device, medium.data(), opacity, endless, blocks, timer, progress), Error);
    canceller.join();
    EXPECT_LT(steady_clock::now() - asked, 500ms);
}
