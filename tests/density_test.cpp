// The density that light is followed through: optical depth across cells, and its halving.
#include "illumination/visibility/density.h"

#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "classify/medium.h"
#include "fixtures.h"

using namespace chiaro;
using chiaro::testing::constant;
using chiaro::testing::sampled;
using chiaro::testing::tested_device;
using chiaro::testing::two_materials;

namespace {

/// A classified volume and the opacity of its cells.
struct Lit {
    Medium medium;
    CellOpacity opacity;

    Lit(const Volume& volume, const TransferFunction& tf, const Shape& shape = {})
        : medium(classify(upload(tested_device(), volume), tf, shape)), opacity(cell_opacity(medium.data(), quiet())) {}
    Density density(int subsample = 1, const Device& device = tested_device()) const {
        return density_for(medium.data(), subsample, device, quiet());
    }
    static Progress& quiet() {
        static Progress progress;
        return progress;
    }
};

double at(const Density& density, int x, int y, int z) { return density.data()[density.grid.index(x, y, z)]; }

bool same(const Density& a, const Density& b) {
    return a.grid.count == b.grid.count && std::memcmp(a.data(), b.data(), a.buffer.size()) == 0;
}

/// Opaque around 125 alone.
TransferFunction thin_peak() {
    TransferFunction tf;
    tf.points = {{120, {1, 1, 1}, 0}, {125, {1, 1, 1}, 0.9}, {130, {1, 1, 1}, 0}};
    return tf;
}

/// κ of a transfer function per voxel edge, in 20 000 steps from one value to another.
double mean_extinction(const TransferFunction& tf, double a, double b) {
    constexpr int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) sum -= std::log1p(-evaluate(tf, a + (i + 0.5) / steps * (b - a)).opacity);
    return sum / steps;
}

/// Spots of all values, so that every neighbour differs.
template <class T>
Volume noise(std::array<int, 3> n, double scale) {
    std::mt19937 random(7);
    return sampled<T>(n, [&](double, double, double) { return scale * double(random() % 256); });
}

template <class T>
class DensityOf : public ::testing::Test {};
using StoredTypes = ::testing::Types<std::uint8_t, std::uint16_t, float>;
TYPED_TEST_SUITE(DensityOf, StoredTypes);

TYPED_TEST(DensityOf, CellsIsTheIntegralAcrossThem) {
    const std::array n{35, 9, 33};
    const double scale = std::is_same_v<TypeParam, std::uint16_t> ? 4 : 1;
    const Volume volume = noise<TypeParam>(n, scale);
    TransferFunction tf = two_materials();
    for (auto& point : tf.points) point.value *= scale;
    const Density density = Lit(volume, tf).density();
    const auto value = [&](int x, int y, int z) {
        const auto inside = [&](int v, int axis) { return std::clamp(v, 0, n[axis] - 1); };
        return double(volume.as<TypeParam>()[(std::size_t(inside(z, 2)) * n[1] + inside(y, 1)) * n[0] + inside(x, 0)]);
    };
    for (std::array p : {std::array{0, 0, 0}, {34, 8, 32}, {32, 4, 31}, {31, 3, 32}, {33, 8, 0}, {5, 4, 17}}) {
        const double f = value(p[0], p[1], p[2]);
        double depth = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (int side : {-1, 1}) {
                std::array q = p;
                q[axis] += side;
                depth += mean_extinction(tf, f, (f + value(q[0], q[1], q[2])) / 2) / 6;
            }
        EXPECT_NEAR(at(density, p[0], p[1], p[2]), depth, 2e-3 * depth + 1e-4) << p[0] << " " << p[1] << " " << p[2];
    }
}

TEST(Density, APeakBetweenTwoVoxelsIsNotMissed) {
    const Volume step = sampled<std::uint8_t>({16, 8, 8}, [](double x, double, double) { return x < 8 ? 100 : 150; });
    const Lit lit(step, thin_peak());
    const Density points = density_of(lit.opacity, 1, tested_device(), Lit::quiet()), across = lit.density();
    const double crossed = mean_extinction(thin_peak(), 100, 150);
    EXPECT_GT(crossed, 0.1);
    EXPECT_EQ(at(points, 7, 4, 4) + at(points, 8, 4, 4), 0);
    EXPECT_NEAR(at(across, 7, 4, 4) + at(across, 8, 4, 4), crossed / 3, 1e-3);
    EXPECT_EQ(at(across, 6, 4, 4) + at(across, 9, 4, 4), 0);
}

TEST(Density, OfAConstantMedium) {
    for (double alpha : {0.001, 0.3, 0.999}) {
        const Lit lit(sampled<std::uint8_t>({40, 20, 9}, [](double, double, double) { return 77; }), constant(alpha));
        for (int subsample : {1, 2, 4, 8}) {
            const double kappa = -std::log1p(-alpha) * subsample;
            const Density density = lit.density(subsample);
            EXPECT_NEAR(at(density, 1, 1, 0), kappa, 1e-6 + 2e-6 * kappa) << subsample;
        }
    }
}

TEST(Density, IsThatOfPointsWhereValuesChangeSlowly) {
    const auto soft = [](double x, double y, double z) { return 100 + 30 * std::sin(0.1 * x + 0.07 * y - 0.05 * z); };
    TransferFunction ramp;
    ramp.points = {{0, {1, 1, 1}, 0}, {255, {1, 1, 1}, 0.5}};
    const Lit lit(sampled<float>({40, 33, 21}, soft), ramp);
    const Density points = density_of(lit.opacity, 1, tested_device(), Lit::quiet()), across = lit.density();
    for (std::size_t i = 0; i < points.grid.size(); ++i) ASSERT_NEAR(across.data()[i], points.data()[i], 3e-3);
}

TEST(Density, ClippedAndThresholdedMatterStopsNothing) {
    const Volume solid =
        sampled<std::uint8_t>({20, 20, 20}, [](double x, double, double) { return x < 10 ? 200 : 50; });
    Shape shape;
    shape.clip.box = {0.6, 1.0, 0.0, 1.0, 0.0, 1.0};
    const Density clipped = Lit(solid, constant(0.5), shape).density();
    EXPECT_EQ(at(clipped, 11, 5, 5), 0);
    EXPECT_NEAR(at(clipped, 12, 5, 5), std::log(2), 1e-6);
    const Density cut = Lit(solid, constant(0.5), {.threshold_high = 100}).density();
    EXPECT_EQ(at(cut, 8, 5, 5), 0);
    EXPECT_NEAR(at(cut, 11, 5, 5), std::log(2), 1e-6);
    EXPECT_NEAR(at(cut, 10, 5, 5), std::log(2) * (5 + 2 * 50 / 75.0 - 1.0 / 3) / 6, 0.1);  // up to 100 of 50 to 125
}

TEST(Density, OfSurfacesIsTheirCoverage) {
    const Volume ball = make_sample("ball", 40);
    Shape shape{.mode = Mode::iso, .iso = {{100}}};
    const Lit lit(ball, two_materials(), shape);
    EXPECT_TRUE(same(lit.density(2), density_of(lit.opacity, 2, tested_device(), Lit::quiet())));
    EXPECT_GT(at(lit.density(), 20, 20, 20), 15);
}

TYPED_TEST(DensityOf, ThickSlicesIsThatOfCubes) {
    // Slices twice as thick as wide, of a value that is linear along z: the cells are those of the fine volume.
    const auto f = [](double x, double, double z) { return 60 + 2 * x + 4 * z; };
    Volume thick = sampled<TypeParam>({24, 10, 16}, [&](double x, double y, double z) { return f(x, y, 2 * z + 0.5); });
    thick.geometry.spacing_mm = {1, 1, 2};
    const Density coarse = Lit(thick, two_materials()).density(),
                  fine = Lit(sampled<float>({24, 10, 32}, f), two_materials()).density();
    ASSERT_EQ(coarse.grid.count, fine.grid.count);
    for (int z = 2; z < 30; ++z)
        for (int x = 0; x < 24; ++x) ASSERT_NEAR(at(coarse, x, 5, z), at(fine, x, 5, z), 1e-3) << x << " " << z;
}

TEST(Density, OfThickSlicesIsTheSameInPieces) {
    // Matter in a few pieces of a block only: what lies beside them is left out, and must not be needed.
    const auto f = [](double x, double y, double z) {
        return std::hypot(x - 21, y - 9, 2 * (z - 12)) < 5 || (x == 15 && y == 20) ? 90 + x + y : 10;
    };
    const auto thick = [&](auto voxel) {
        Volume volume = sampled<decltype(voxel)>({40, 33, 20}, f);
        volume.geometry.spacing_mm = {1, 1, 2};
        return Lit(volume, two_materials()).density();
    };
    Volume filled = sampled<float>({40, 33, 20}, f);
    filled.geometry.spacing_mm = {1, 1, 2};
    TransferFunction tf = two_materials();
    tf.points.insert(tf.points.begin(), {{0, {0, 0, 0}, 1e-5}, {59.999, {0, 0, 0}, 1e-5}});
    const Density all = Lit(filled, tf).density(), some = thick(float{}), levels = thick(std::uint16_t{});
    for (std::size_t i = 0; i < all.grid.size(); ++i) {
        ASSERT_NEAR(some.data()[i], all.data()[i], 1.1e-4) << i;
        ASSERT_NEAR(levels.data()[i], some.data()[i], 1e-3) << i;
    }
}

/// -ln of the geometric mean over the axes of the mean transmittance of a block's columns.
double halved_depth(const Density& d, int x, int y, int z) {
    const auto open = [&](int i, int j, int k) {
        const bool inside = i < d.grid.count[0] && j < d.grid.count[1] && k < d.grid.count[2];
        return inside ? std::exp(-at(d, i, j, k)) : 1;
    };
    double product = 1;
    for (int axis = 0; axis < 3; ++axis) {
        double mean = 0;
        for (int column = 0; column < 4; ++column) {
            std::array a{2 * x, 2 * y, 2 * z};
            a[(axis + 1) % 3] += column & 1, a[(axis + 2) % 3] += column >> 1;
            std::array b = a;
            ++b[axis];
            mean += open(a[0], a[1], a[2]) * open(b[0], b[1], b[2]) / 4;
        }
        product *= mean;
    }
    return -std::log(product) / 3;
}

TEST(Density, HalvesAsColumnsLetLightThrough) {
    const Lit lit(noise<std::uint8_t>({35, 67, 33}, 1), two_materials());
    const Density fine = lit.density(), half = lit.density(2);
    ASSERT_EQ(half.grid.count, (std::array{18, 34, 17}));
    EXPECT_EQ(half.grid.voxels_per_cell.x, 2);
    for (int z = 0; z < 17; ++z)
        for (int y = 0; y < 34; ++y)
            for (int x = 0; x < 18; ++x)
                ASSERT_NEAR(at(half, x, y, z), halved_depth(fine, x, y, z), 3e-6 + 3e-6 * at(half, x, y, z));
    EXPECT_TRUE(same(half, halved(fine, tested_device(), Lit::quiet())));
    EXPECT_TRUE(same(lit.density(8), halved(lit.density(4), tested_device(), Lit::quiet())));
}

TEST(Density, ThreadsAndInstructionSetsGiveTheSameBits) {
    const Lit lit(noise<std::uint16_t>({70, 37, 40}, 1), two_materials());
    for (int subsample : {1, 2, 8}) {
        const Density scalar = lit.density(subsample, Device::cpu(1, Isa::scalar));
        for (Isa isa : available_isas())
            EXPECT_TRUE(same(scalar, lit.density(subsample, Device::cpu(3, isa)))) << name_of(isa);
    }
}

TEST(Density, StopsWhenCancelled) {
    const Lit lit(noise<std::uint8_t>({40, 40, 40}, 1), two_materials());
    Progress progress;
    progress.cancel();
    EXPECT_THROW(density_for(lit.medium.data(), 2, tested_device(), progress), Error);
}

}  // namespace
