// Visibility in spherical harmonics by brute force: closed forms, and its ties to the mean over the sphere.
#include "illumination/reference/visibility.h"

#include <chiaro/error.h>

#include <cstring>
#include <numbers>

#include "fixtures.h"
#include "illumination/access.h"
#include "illumination/sh/directions.h"
#include "tool_case.h"

namespace {

using namespace chiaro;
using chiaro::testing::constant;
using chiaro::testing::sampled;
using chiaro::testing::tested_device;
using chiaro::testing::two_materials;

constexpr double pi = std::numbers::pi;

/// A classified volume and the rays through it.
struct Rays {
    TransferFunction tf = two_materials();
    ReferenceSettings settings{.rays = 1024};
    Device device = tested_device();
    Shape shape = {};

    ShField operator()(const Volume& volume) const {
        Progress progress;
        StageTimer timer;
        const Medium medium = classify(upload(device, volume), tf, shape);
        const CellOpacity opacity = cell_opacity(medium.data(), progress);
        return reference_visibility(device, medium.data(), opacity, settings, timer, progress);
    }
};

const float* at(const ShField& field, int x, int y, int z) { return field.node(field.grid.index(x, y, z)); }

TransferFunction opaque() {
    TransferFunction tf;
    tf.points = {{100, {1, 1, 1}, 0}, {110, {1, 1, 1}, 1}};
    return tf;
}

Volume blobs(std::array<int, 3> n) {
    return sampled<std::uint8_t>(
        n, [](double x, double y, double z) { return 120 + 110 * std::sin(0.4 * x) * std::cos(0.5 * y + 0.2 * z); });
}

TEST(ReferenceVisibility, OfEmptySpaceIsTheConstant) {
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        const ShField field = Rays{.tf = constant(0), .settings = {.rays = 4096, .medium = medium}}(
            sampled<std::uint8_t>({9, 7, 5}, [](double, double, double) { return 9; }));
        for (int c = 0; c < 16; ++c) EXPECT_NEAR(at(field, 4, 3, 2)[c], c == 0 ? std::sqrt(4 * pi) : 0, 2e-3) << c;
    }
}

TEST(ReferenceVisibility, OnAnOpaqueHalfSpace) {
    const double want[] = {std::sqrt(pi), std::sqrt(3 * pi) / 2, 0, std::sqrt(7 * pi) / 8};
    for (int axis = 0; axis < 3; ++axis)
        for (int sign : {-1, 1}) {
            std::array n{257, 257, 257};
            n[axis] = 5;
            const Volume ground = sampled<std::uint8_t>(n, [&](double x, double y, double z) {
                const double p = (axis == 0 ? x : axis == 1 ? y : z) - 2;
                return sign * p < 0 ? 255 : 0;
            });
            std::array node{128, 128, 128};
            node[axis] = 2;
            Progress progress;
            StageTimer timer;
            const Medium medium = classify(upload(tested_device(), ground), opaque(), {});
            const CellOpacity opacity = cell_opacity(medium.data(), progress);
            const ExtinctionCells cells(medium.data(), opacity, 1, tested_device(), progress);
            const RunHarmonics found = trace_harmonics(tested_device(), cells, 1, 1, 4096, {node}, progress)[0];
            // Y_l0 about z; about x and y the bands keep their lengths, and the first points there.
            EXPECT_NEAR(found[0][0], want[0], 0.02);
            const int first = axis == 0 ? 3 : axis == 1 ? 1 : 2;
            EXPECT_NEAR(found[first][0], sign * want[1], 0.02) << axis;
            for (int band = 0, c = 0; band < 4; ++band) {
                double squares = 0;
                for (; c < (band + 1) * (band + 1); ++c) squares += found[c][0] * found[c][0];
                EXPECT_NEAR(std::sqrt(squares), want[band], 0.03) << axis << " " << band;
            }
            if (axis == 2) {
                EXPECT_NEAR(found[12][0], -sign * want[3], 0.03);
            }
        }
}

TEST(ReferenceVisibility, ThroughARoundWindow) {
    // A thin opaque screen above the node, open within a cone of half angle θ about +z.
    const double theta = pi / 4;
    const Volume screen = sampled<std::uint8_t>({161, 161, 41}, [&](double x, double y, double z) {
        const double r = std::hypot(x - 80, y - 80);
        const bool above = z >= 40 && r > 38 * std::tan(theta);
        const bool beside = z < 40 && (x < 1 || x > 159 || y < 1 || y > 159 || z < 1);
        return above || beside ? 255 : 0;
    });
    Progress progress;
    const Medium medium = classify(upload(tested_device(), screen), opaque(), {});
    const CellOpacity opacity = cell_opacity(medium.data(), progress);
    const ExtinctionCells cells(medium.data(), opacity, 1, tested_device(), progress);
    const RunHarmonics found = trace_harmonics(tested_device(), cells, 1, 1, 4096, {{80, 80, 2}}, progress)[0];
    // Y_l0 over the cap: c_00 = √π (1 - cos θ), c_10 = √(3π)/2 sin² θ
    EXPECT_NEAR(found[0][0], std::sqrt(pi) * (1 - std::cos(theta)), 0.02);
    EXPECT_NEAR(found[2][0], std::sqrt(3 * pi) / 2 * std::pow(std::sin(theta), 2), 0.03);
    EXPECT_NEAR(found[1][0], 0, 0.01);
    EXPECT_NEAR(found[3][0], 0, 0.01);
}

TEST(ReferenceVisibility, BandZeroIsObscurance) {
    const Volume volume = blobs({37, 20, 18});
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        Rays rays{.settings = {.rays = 96, .medium = medium}};
        const ShField field = rays(volume);
        Progress progress;
        StageTimer timer;
        const Medium classified = classify(upload(rays.device, volume), rays.tf, {});
        const CellOpacity opacity = cell_opacity(classified.data(), progress);
        const IlluminationSettings settings{.method = Method::reference, .reference = rays.settings};
        const CellValues access = accessibility(rays.device, classified.data(), opacity, settings,
                                                BlockMap(opacity.values.grid.count, true), timer, progress);
        for (std::size_t i = 0; i < field.grid.size(); ++i)
            ASSERT_NEAR(field.node(i)[0] / std::sqrt(4 * pi), access.data()[i] / cell_one, 1.0 / 65535) << i;
    }
}

/// V through κ of every cell, from any point, by steps of a hundredth of an edge.
double marched(const std::vector<double>& kappa, int n, Vec3 from, const Vec3& d, double start) {
    const double steepest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    double depth = 0;
    for (double t = 0.5 * start / steepest + 0.005;; t += 0.01) {
        const Vec3 p = from + t * d;
        const int x = int(std::lround(p.x)), y = int(std::lround(p.y)), z = int(std::lround(p.z));
        if (std::min({p.x, p.y, p.z}) < -0.5 || std::max({p.x, p.y, p.z}) > n - 0.5) return std::exp(-depth);
        depth += 0.01 * kappa[std::size_t((z * n + y) * n + x)];
    }
}

TEST(ReferenceVisibility, NodesOfSeveralCellsLieAtTheirCentre) {
    const int n = 24;
    const Volume volume = blobs({n, n, n});
    const TransferFunction tf = two_materials();
    std::vector<double> kappa;
    for (auto v : volume.as<std::uint8_t>()) kappa.push_back(-std::log1p(-evaluate(tf, v).opacity));
    for (int subsample : {2, 3, 8})
        for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
            const Rays rays{.settings = {.rays = 40, .medium = medium, .subsample = subsample}};
            const ShField field = rays(volume);
            EXPECT_EQ(field.grid.count[0], n / subsample);
            const Vec3 from{subsample + (subsample - 1) / 2.0, (subsample - 1) / 2.0,
                            2 * subsample + (subsample - 1) / 2.0};
            std::array<double, 16> want{};
            for (const Vec3& d : fibonacci_directions(40))
                for (int c = 0; c < 16; ++c)
                    want[c] += 4 * pi / 40 * marched(kappa, n, from, d, 1) * spherical_harmonics(d)[c];
            // The interpolated medium is another one; it only must be asked from the same place.
            for (int c = 0; c < 16; ++c)
                EXPECT_NEAR(at(field, 1, 0, 2)[c], want[c], medium == ReferenceMedium::voxels ? 0.01 : 0.12)
                    << subsample << " " << c;
        }
}

TEST(ReferenceVisibility, RunsAreTheFieldsNodes) {
    const Volume volume = blobs({40, 24, 32});
    for (int subsample : {1, 4}) {
        const Rays rays{.settings = {.rays = 64, .subsample = subsample}};
        const ShField field = rays(volume);
        Progress progress;
        const Medium medium = classify(upload(rays.device, volume), rays.tf, {});
        const ExtinctionCells cells(medium.data(), cell_opacity(medium.data(), progress), subsample, rays.device,
                                    progress);
        const auto runs = trace_harmonics(rays.device, cells, subsample, 1, 64, {{3, 2, 5}, {0, 1, 7}}, progress);
        for (int i = 0; i < 40 / subsample - 3 && i < 16; ++i)
            for (int c = 0; c < 16; ++c) ASSERT_EQ(float(runs[0][c][i]), at(field, 3 + i, 2, 5)[c]) << subsample;
        for (int c = 0; c < 16; ++c) ASSERT_EQ(float(runs[1][c][0]), at(field, 0, 1, 7)[c]) << subsample;
    }
}

TEST(ReferenceVisibility, ThreadsAndInstructionSetsGiveTheSameBits) {
    const Volume volume = blobs({37, 11, 9});
    for (auto medium : {ReferenceMedium::voxels, ReferenceMedium::trilinear}) {
        Rays rays{.settings = {.rays = 12, .medium = medium}};
        rays.device = Device::cpu(1, Isa::scalar);
        const ShField scalar = rays(volume);
        for (Isa isa : available_isas()) {
            rays.device = Device::cpu(3, isa);
            const ShField other = rays(volume);
            EXPECT_EQ(std::memcmp(scalar.buffer.data(), other.buffer.data(), scalar.buffer.size()), 0) << name_of(isa);
        }
    }
}

using ReferenceVisibilityTool = ToolTest;

TEST_F(ReferenceVisibilityTool, WritesCoefficientsFirst) {
    const std::string line =
        "illuminate sample:ball:16 --lighting reference --reference-quantity visibility "
        "--reference-rays 64 -o f.nrrd";
    ASSERT_EQ(tool(line).code, 0);
    const std::string file = read("f.nrrd");
    EXPECT_NE(file.find("sizes: 16 16 16 16\nkinds: list space space space"), file.npos);
    EXPECT_NE(file.find("chiaro_field:=visibility"), file.npos);
    EXPECT_NE(file.find("chiaro_sh_axes:=grid"), file.npos);
    ASSERT_EQ(tool(line + " --reference-subsample 4").code, 0);
    EXPECT_NE(read("f.nrrd").find("sizes: 16 4 4 4\n"), file.npos);
    EXPECT_NE(read("f.nrrd").find("(4,0,0) (0,4,0) (0,0,4)"), file.npos);
    const Said said = tool("render sample:ball:16 --lighting reference --reference-quantity visibility -o f.png");
    EXPECT_EQ(said.code, 2);
    EXPECT_NE(said.err.find("write it with chiaro illuminate"), said.err.npos) << said.err;
}

}  // namespace
