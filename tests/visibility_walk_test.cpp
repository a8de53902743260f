// The published way to visibility: its pyramid, the walk through it, and the error against rays.
#include "illumination/visibility/walk.h"

#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "classify/medium.h"
#include "fixtures.h"
#include "illumination/reference/visibility.h"
#include "illumination/sh/directions.h"

using namespace chiaro;
using chiaro::testing::constant;
using chiaro::testing::sampled;
using chiaro::testing::tested_device;
using chiaro::testing::two_materials;

namespace {

constexpr double pi = std::numbers::pi;
constexpr auto hierarchical = VisibilityTraversal::hierarchical, full = VisibilityTraversal::full;

Progress& quiet() {
    static Progress progress;
    return progress;
}

Density density_of_volume(const Volume& volume, const TransferFunction& tf, int subsample = 1) {
    return density_for(classify(upload(tested_device(), volume), tf, {}).data(), subsample, tested_device(), quiet());
}

ShField walked(const Density& density, const VisibilitySettings& settings, double start = 0.5,
               const Device& device = tested_device()) {
    StageTimer timer;
    return walk_visibility(device, density, settings, start, timer, quiet());
}

const float* at(const ShField& field, int x, int y, int z) { return field.node(field.grid.index(x, y, z)); }

/// Some runs of nodes, with what rays through the same density find there.
struct GroundTruth {
    const Density& density;
    double start;
    std::vector<std::array<int, 3>> first;
    std::vector<RunHarmonics> by_rays;

    GroundTruth(const Density& d, double begin, int rays) : density(d), start(begin) {
        const auto [nx, ny, nz] = density.grid.count;
        for (int z = 0; z < nz; z += 7)
            for (int y = z % 5; y < ny; y += 5)
                for (int x = 0; x < nx; x += 16) first.push_back({x, y, z});
        const ExtinctionCells cells(density, 1, tested_device(), quiet());
        by_rays = trace_harmonics(tested_device(), cells, 1, 2 * start, rays, first, quiet());
    }
    /// Relative L2 distance of all coefficients.
    double error_of(const VisibilitySettings& settings) const {
        const VisibilityWalk walk(tested_device(), density, settings, start, quiet());
        double errors = 0, squares = 0;
        for (std::size_t r = 0; r < first.size(); ++r) {
            VisibilityWalk::Run found;
            walk(first[r][0], first[r][1], first[r][2], found);
            for (int i = 0; i < std::min(16, density.grid.count[0] - first[r][0]); ++i)
                for (int c = 0; c < 16; ++c)
                    errors += std::pow(found[c][i] - by_rays[r][c][i], 2), squares += std::pow(by_rays[r][c][i], 2);
        }
        return std::sqrt(errors / squares);
    }
};

TEST(TransparencyPyramid, OfAHomogeneousMedium) {
    const double kappa = 0.05;
    const Density density = density_of_volume(
        sampled<std::uint8_t>({40, 33, 32}, [](double, double, double) { return 9; }), constant(-std::expm1(-kappa)));
    const TransparencyPyramid pyramid(density, 2, quiet());
    EXPECT_EQ(pyramid.levels().size(), 7);
    for (int l = 0; l < 5; ++l)
        EXPECT_NEAR(pyramid.levels()[l].data()[0] / cell_one, std::exp(-kappa * std::exp2(l)), (l + 1) / cell_one) << l;
    // 33 nodes: of the 5 at level 3 the last holds one row of matter, the others are open.
    const CellValues& third = pyramid.levels()[3];
    EXPECT_EQ(third.grid.count, (std::array{5, 5, 4}));
    EXPECT_GT(third.data()[third.grid.index(0, 4, 0)], third.data()[0] * 1.2);
    EXPECT_EQ(pyramid.levels()[6].grid.size(), 1);
}

TEST(TransparencyPyramid, TwoOpaqueOfFourCellsLeaveAQuarter) {
    // The published Figure 3: one behind the other or side by side, this rule makes no difference.
    for (bool behind : {true, false}) {
        const Volume volume = sampled<std::uint8_t>(
            {8, 8, 8}, [&](double x, double y, double) { return (behind ? int(y) : int(x)) % 2 ? 255 : 0; });
        TransferFunction tf;
        tf.points = {{254, {1, 1, 1}, 0}, {255, {1, 1, 1}, 1}};
        const CellOpacity opacity = cell_opacity(classify(upload(tested_device(), volume), tf, {}).data(), quiet());
        const TransparencyPyramid pyramid(density_of(opacity, 1, tested_device(), quiet()), 1, quiet());
        EXPECT_NEAR(pyramid.levels()[1].data()[0] / cell_one, 0.25, 1e-4);
    }
}

TEST(Walk, ThroughEmptySpaceMeetsNothing) {
    const Density density =
        density_of_volume(sampled<std::uint8_t>({19, 7, 5}, [](double, double, double) { return 9; }), constant(0));
    for (auto traversal : {hierarchical, full}) {
        const ShField field = walked(density, {.directions = 4096, .traversal = traversal});
        for (int x : {0, 9, 18})
            for (int c = 0; c < 16; ++c) EXPECT_NEAR(at(field, x, 3, 2)[c], c == 0 ? std::sqrt(4 * pi) : 0, 2e-3) << c;
    }
}

TEST(Walk, OnAnOpaqueHalfSpace) {
    TransferFunction tf;
    tf.points = {{254, {1, 1, 1}, 0}, {255, {1, 1, 1}, 1}};
    const Volume ground =
        sampled<std::uint8_t>({129, 129, 9}, [](double, double, double z) { return z < 4 ? 255 : 0; });
    const CellOpacity opacity = cell_opacity(classify(upload(tested_device(), ground), tf, {}).data(), quiet());
    const Density density = density_of(opacity, 1, tested_device(), quiet());
    VisibilityWalk::Run found;
    VisibilityWalk(tested_device(), density, {.directions = 4096, .traversal = full}, 0.5, quiet())(64, 64, 5, found);
    // Two nodes above the ground's last; trilinear transparency begins half a node above its surface.
    EXPECT_NEAR(found[0][0], std::sqrt(pi), 0.1);
    EXPECT_NEAR(found[2][0], std::sqrt(3 * pi) / 2, 0.03);
    EXPECT_NEAR(found[12][0], -std::sqrt(7 * pi) / 8, 0.05);
    for (int c : {1, 3, 4, 5, 7, 8, 9, 10, 11, 13, 14, 15}) EXPECT_NEAR(found[c][0], 0, 0.02) << c;
}

TEST(Walk, OfAHomogeneousMediumIsExact) {
    const double kappa = 0.03;
    const int n = 32;
    for (int subsample : {1, 2}) {
        const Density density =
            density_of_volume(sampled<std::uint8_t>({n, n, n}, [](double, double, double) { return 9; }),
                              constant(-std::expm1(-kappa)), subsample);
        const double start = 0.5 / subsample;
        std::array<double, 16> want{};
        const double p = (subsample == 1 ? 5 : 10.5) + 0.5;  // node 5, from the corner, in cells
        for (const Vec3& d : fibonacci_directions(400)) {
            double way = 1e9;
            for (int axis = 0; axis < 3; ++axis) way = std::min(way, (d[axis] < 0 ? p : n - p) / std::abs(d[axis]));
            way -= 0.5 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
            for (int c = 0; c < 16; ++c)
                want[c] += 4 * pi / 400 * std::exp(-kappa * way) * chiaro::spherical_harmonics(d)[c];
        }
        for (auto traversal : {hierarchical, full}) {
            VisibilityWalk::Run found;
            VisibilityWalk(tested_device(), density, {.directions = 400, .traversal = traversal}, start, quiet())(
                5, 5, 5, found);
            for (int c = 0; c < 16; ++c) EXPECT_NEAR(found[c][0], want[c], 3e-3) << c << int(traversal);
        }
    }
}

TEST(Walk, ComesNearRays) {
    struct Subject {
        const char* name;
        int subsample;
        double max_full, max_hierarchical;
    };
    for (const auto& [name, subsample, max_full, max_hierarchical] :
         {Subject{"cornell", 1, 0.085, 0.22}, Subject{"cornell", 2, 0.19, 0.38}, Subject{"fog", 1, 0.003, 0.003},
          Subject{"fog", 2, 0.003, 0.003}}) {
        const Density density =
            density_of_volume(make_sample(name, 32 * subsample), sample_transfer_function(name), subsample);
        const GroundTruth ground_truth(density, 0.5 / subsample, 1024);
        const auto error = [&](VisibilityTraversal traversal, VisibilityModel model) {
            return ground_truth.error_of({.directions = 400, .traversal = traversal, .model = model});
        };
        const double of_full = error(full, VisibilityModel::corrected),
                     of_steps = error(hierarchical, VisibilityModel::corrected),
                     of_papers = error(hierarchical, VisibilityModel::paper);
        EXPECT_LT(of_full, max_full) << name << subsample;
        EXPECT_LT(of_steps, max_hierarchical) << name << subsample;
        EXPECT_LT(of_full, 1.1 * of_steps) << name << subsample;
        EXPECT_LT(of_steps, of_papers) << name << subsample;
        RecordProperty(name + std::to_string(subsample), std::to_string(of_full) + " " + std::to_string(of_steps));
    }
}

TEST(Walk, TwoBandsAreTheFirstFourCoefficients) {
    const Density density = density_of_volume(make_sample("cornell", 20), sample_transfer_function("cornell"));
    const ShField four = walked(density, {.bands = 2, .directions = 50, .traversal = hierarchical}),
                  all = walked(density, {.directions = 50, .traversal = hierarchical});
    for (std::size_t i = 0; i < density.grid.size(); ++i)
        for (int c = 0; c < 4; ++c) ASSERT_EQ(four.node(i)[c], all.node(i)[c]);
}

TEST(Walk, JitteredDirectionsErrMore) {
    // Of empty space, where all is known.
    const Density density =
        density_of_volume(sampled<std::uint8_t>({16, 8, 8}, [](double, double, double) { return 9; }), constant(0));
    const auto error = [&](const ShSampling& sampling) {
        const ShField field = walked(density, {.directions = 100, .traversal = hierarchical, .sampling = sampling});
        double sum = 0;
        for (std::size_t i = 0; i < density.grid.size(); ++i)
            for (int c = 0; c < 16; ++c) sum += std::pow(field.node(i)[c] - (c == 0 ? std::sqrt(4 * pi) : 0), 2);
        return std::sqrt(sum / 16 / double(density.grid.size()));
    };
    const double fibonacci = error({}), jittered = error({true, 16});
    EXPECT_LT(fibonacci, 0.01);
    EXPECT_LT(jittered, 0.12);
    EXPECT_GT(jittered, 3 * fibonacci);
}

TEST(JitteredDirections, HaveEachTheirShareOfTheSphere) {
    for (int count : {4, 7, 100, 401})
        for (int set : {0, 5}) {
            const auto directions = jittered_directions(count, set);
            ASSERT_EQ(int(directions.size()), count);
            int upper = 0;
            for (const Vec3& d : directions) {
                EXPECT_NEAR(length(d), 1, 1e-12);
                upper += d.z > 0;
            }
            EXPECT_NEAR(upper, count / 2.0, 2 + std::sqrt(count));
            EXPECT_EQ(directions.back(), jittered_directions(count, set).back());
            EXPECT_FALSE(directions.back() == jittered_directions(count, set + 1).back());
        }
}

TEST(Walk, ThroughThickSlicesIsThatThroughCubes) {
    const auto f = [](double x, double y, double z) { return 60 + 2 * x + y + 4 * z; };
    Volume thick = sampled<float>({20, 12, 10}, [&](double x, double y, double z) { return f(x, y, 2 * z + 0.5); });
    thick.geometry.spacing_mm = {1, 1, 2};
    const VisibilitySettings settings{.directions = 60, .traversal = hierarchical};
    const ShField coarse = walked(density_of_volume(thick, two_materials()), settings),
                  fine = walked(density_of_volume(sampled<float>({20, 12, 20}, f), two_materials()), settings);
    ASSERT_EQ(coarse.grid.count, fine.grid.count);
    for (int c = 0; c < 16; ++c) EXPECT_NEAR(at(coarse, 9, 6, 10)[c], at(fine, 9, 6, 10)[c], 0.01) << c;
}

TEST(Walk, ThreadsAndInstructionSetsGiveTheSameBits) {
    const Density density = density_of_volume(
        sampled<std::uint8_t>({37, 9, 12}, [](double x, double y, double z) { return 9 * x + 7 * y * z; }),
        two_materials());
    for (auto traversal : {hierarchical, full})
        for (const ShSampling& sampling : {ShSampling{}, ShSampling{true, 3}}) {
            const VisibilitySettings settings{.directions = 21, .traversal = traversal, .sampling = sampling};
            const ShField scalar = walked(density, settings, 0.5, Device::cpu(1, Isa::scalar));
            for (Isa isa : available_isas()) {
                const ShField other = walked(density, settings, 0.5, Device::cpu(3, isa));
                EXPECT_EQ(std::memcmp(scalar.buffer.data(), other.buffer.data(), scalar.buffer.size()), 0)
                    << name_of(isa);
            }
        }
}

TEST(Walk, StopsWhenCancelled) {
    const Density density = density_of_volume(make_sample("fog", 24), sample_transfer_function("fog"));
    Progress progress;
    progress.cancel();
    StageTimer timer;
    EXPECT_THROW(walk_visibility(tested_device(), density, {.traversal = full}, 0.5, timer, progress), Error);
}

}  // namespace
