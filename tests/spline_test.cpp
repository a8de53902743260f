// Cubic B-splines between voxels, against closed forms and sums over all coefficients.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "classify/medium.h"
#include "fixtures.h"
#include "volume/device_view.h"
#include "volume/launch_spline.h"
#include "volume/splined.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

using Point = kernel::Vec3<float>;

/// In data units, whatever the voxels are stored as.
double value_at(const DeviceVolume& volume, Point p) {
    const DeviceVolume::Data& data = volume.data();
    return with_stored_voxel(data, [&](auto zero) {
        const auto view = view_of<decltype(zero)>(data);
        p = view.clamp(p);
        const auto at = view.locate(p, view.voxel(p));
        return data.scale * view.value(at) + data.offset;
    });
}

/// Waves with noise on them.
template <class T>
Volume noise(std::array<int, 3> n) {
    std::mt19937 random(5);
    return sampled<T>(n, [&](double x, double y, double z) {
        return 100 + 60 * std::sin(0.3 * x + 0.4 * y) * std::cos(0.5 * z) + double(random() % 20);
    });
}

template <class Visit>
void for_each_voxel(std::array<int, 3> n, const Visit& visit) {
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) visit(x, y, z);
}

/// The cubic B-spline at a distance.
double bspline(double t) {
    t = std::abs(t);
    return t < 1 ? 2.0 / 3 - t * t + t * t * t / 2 : t < 2 ? (2 - t) * (2 - t) * (2 - t) / 6 : 0;
}

template <class T>
void expect_interpolation(std::array<int, 3> n) {
    const Volume volume = noise<T>(n);
    const DeviceVolume voxels = upload(tested_device(), volume), made = splined(voxels, true);
    // Within half a step of the coefficients' storage, whose weights add up to 1, and rounding of stored values near
    // 2^15.
    const double allowed = std::is_floating_point_v<T> ? 2e-4 : 0.5 * made.data().spline.scale + 0.008;
    double worst = 0;
    std::size_t i = 0;
    for_each_voxel(n, [&](int x, int y, int z) {
        const double found = value_at(made, {float(x), float(y), float(z)});
        worst = std::max(worst, std::abs(found - double(volume.as<T>()[i++])));
    });
    EXPECT_LT(worst, allowed) << n[0] << " " << n[1] << " " << n[2];
    const double coarsest = std::is_same_v<T, std::uint8_t> ? 2.5 : 1.01;
    EXPECT_LT(made.data().spline.scale, coarsest);
}

const std::array<int, 3> across_bricks{70, 41, 37};

}  // namespace

TEST(Spline, GoesThroughTheVoxels) {
    for (const auto n : {across_bricks, {5, 1, 40}, {2, 3, 66}, {33, 34, 1}}) {
        expect_interpolation<std::uint8_t>(n);
        expect_interpolation<std::int16_t>(n);
        expect_interpolation<float>(n);
    }
}

TEST(Spline, ReproducesLinearRampsToTheBorder) {
    const auto ramp = [](double x, double y, double z) { return 3 + 2 * x - y + 0.5 * z; };
    const DeviceVolume made = splined(upload(tested_device(), sampled<float>(across_bricks, ramp)), true);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> u(0, 1);
    for (int i = 0; i < 5000; ++i) {
        const Point p{69 * u(random), 40 * u(random), 36 * u(random)};
        ASSERT_NEAR(value_at(made, p), ramp(p.x, p.y, p.z), 2e-4) << p.x << " " << p.y << " " << p.z;
    }
}

TEST(Spline, ReproducesQuadraticsAndTheirGradients) {
    const auto f = [](double x, double y, double z) {
        return 0.5 * x * x - 0.25 * y * y + 0.125 * z * z + 0.1 * x * y - 0.2 * y * z + x;
    };
    const DeviceVolume made = splined(upload(tested_device(), sampled<float>(across_bricks, f)), true);
    const auto view = view_of<float>(made.data());
    std::mt19937 random(2);
    std::uniform_real_distribution<float> u(0, 1);
    for (int i = 0; i < 5000; ++i) {
        const Point p{14 + 40 * u(random), 14 + 12 * u(random), 14 + 8 * u(random)};
        ASSERT_NEAR(value_at(made, p), f(p.x, p.y, p.z), 2e-3);
        const kernel::Location<float> at = view.locate(p, view.voxel(p));
        const Point g = view.gradient(at);
        ASSERT_NEAR(g.x, p.x + 0.1 * p.y + 1, 2e-3);
        ASSERT_NEAR(g.y, -0.5 * p.y + 0.1 * p.x - 0.2 * p.z, 2e-3);
        ASSERT_NEAR(g.z, 0.25 * p.z - 0.2 * p.y, 2e-3);
    }
}

TEST(Spline, SmoothsByTheSumOverItsCoefficients) {
    const std::array<int, 3> n{40, 34, 9};
    const Volume volume = noise<std::uint8_t>(n);
    const DeviceVolume made = splined(upload(tested_device(), volume), false);
    const auto voxel = [&](int x, int y, int z) {
        const auto inside = [](int i, int count) { return std::clamp(i, 0, count - 1); };
        return double(
            volume
                .as<std::uint8_t>()[std::size_t((inside(z, n[2]) * n[1] + inside(y, n[1])) * n[0] + inside(x, n[0]))]);
    };
    const auto expected = [&](Point p) {
        double sum = 0;
        const int x0 = int(p.x), y0 = int(p.y), z0 = int(p.z);
        for (int k = z0 - 1; k < z0 + 4; ++k)
            for (int j = y0 - 1; j < y0 + 4; ++j)
                for (int i = x0 - 1; i < x0 + 4; ++i)
                    sum += voxel(i, j, k) * bspline(p.x - i) * bspline(p.y - j) * bspline(p.z - k);
        return sum;
    };
    std::mt19937 random(3);
    std::uniform_real_distribution<float> u(0, 1);
    for (int i = 0; i < 3000; ++i) {
        const Point p{39 * u(random), 33 * u(random), 8 * u(random)};
        ASSERT_NEAR(value_at(made, p), expected(p), 1e-3) << p.x << " " << p.y << " " << p.z;
    }
    // What reads voxels reads the same: light is classified from them.
    const auto view = view_of<std::uint8_t>(made.data());
    for_each_voxel(n, [&](int x, int y, int z) {
        const Point p{float(x), float(y), float(z)};
        const double stored = view.voxels[voxel_index(made.data(), x, y, z)];
        ASSERT_NEAR(stored, expected(p), 0.501) << x << " " << y << " " << z;
    });
}

// No value lies beyond the range of its cell, by which empty space is skipped and paths are bounded.
TEST(Spline, KeepsToTheRangesOfItsCells) {
    const std::array<int, 3> n{66, 35, 39};
    for (const Volume& volume : {noise<std::uint8_t>(n), noise<std::int16_t>(n), noise<float>(n)})
        for (const bool interpolates : {true, false}) {
            const DeviceVolume made = splined(upload(tested_device(), volume), interpolates);
            const DeviceVolume::Data& data = made.data();
            double least = 1e9, largest = -1e9;
            std::mt19937 random(4);
            std::uniform_real_distribution<float> u(0, 1);
            for (int i = 0; i < 30000; ++i) {
                const Point p{65 * u(random), 34 * u(random), 38 * u(random)};
                const double stored = (value_at(made, p) - data.offset) / data.scale;
                const auto& count = data.cells.count;
                const std::size_t cell =
                    (std::size_t(int(p.z) / cell_edge) * count[1] + int(p.y) / cell_edge) * count[0] +
                    std::size_t(int(p.x) / cell_edge);
                ASSERT_GE(stored, data.cells.low[cell]);
                ASSERT_LE(stored, data.cells.high[cell]);
                least = std::min(least, stored), largest = std::max(largest, stored);
            }
            EXPECT_EQ(interpolates, largest > data.stored_max);  // it swings over
        }
}

// What pictures and light depend on, in the last bit.
TEST(Spline, IsTheSameByAllInstructionSetsAndThreads) {
    const std::array<int, 3> n{66, 35, 39};
    const auto bytes_of = [](const VoxelBuffer& buffer, std::size_t count) {
        return std::vector<std::byte>(buffer.data(), buffer.data() + count);
    };
    for (const Volume& volume : {noise<std::uint8_t>(n), noise<std::int16_t>(n), noise<float>(n)})
        for (const bool interpolates : {true, false}) {
            const DeviceVolume one = splined(upload(Device::cpu(1, Isa::scalar), volume), interpolates);
            const DeviceVolume::Data& a = one.data();
            const std::size_t read = std::size_t(slices_read(n[2], 0) * brick_slice) * size_of(a.stored);
            for (const Isa isa : available_isas()) {
                const DeviceVolume other = splined(upload(Device::cpu(3, isa), volume), interpolates);
                const DeviceVolume::Data& b = other.data();
                EXPECT_EQ(bytes_of(a.coefficients, read), bytes_of(b.coefficients, read));
                EXPECT_EQ(bytes_of(a.bricks, read), bytes_of(b.bricks, read));
                EXPECT_EQ(a.spline.base, b.spline.base);
                EXPECT_EQ(a.spline.scale, b.spline.scale);
                EXPECT_EQ(a.cells.low, b.cells.low);
                EXPECT_EQ(a.cells.high, b.cells.high);
            }
        }
}

// A brick's cells are refined together; each is what it would be alone.
TEST(Spline, CellsAreRefinedAsEachAlone) {
    std::mt19937 random(8);
    std::vector<std::uint16_t> brick(brick_voxels);
    for (std::uint16_t& code : brick) code = std::uint16_t(random());
    constexpr int slices = 24, layers = 0b00101011;  // some of them, and fewer slices than the last of these touches
    const auto coefficient = [&](int x, int y, int z) {
        return double(brick[std::size_t((std::min(z, slices - 1) * brick_row + y) * brick_row + x)]);
    };
    // Along an axis knot i of a cell takes two or three coefficients.
    const auto refined = [](int i, const auto& at) {
        return i % 2 == 0 ? (at(i / 2) + at(i / 2 + 1)) / 2 : (at(i / 2) + 6 * at(i / 2 + 1) + at(i / 2 + 2)) / 8;
    };
    for (const Isa isa : available_isas()) {
        kernel::CellBounds bounds;
        const kernel::CodeFunctions<std::uint16_t> run = kernel::spline_functions_for(isa);
        run.find_bounds(brick.data(), slices, layers, bounds);
        for (int cell = 0; cell < 512; cell += 7) {
            const int x0 = cell % 8 * 4, y0 = cell / 8 % 8 * 4, z0 = cell / 64 * 4;
            if (!(layers >> (cell / 64) & 1)) continue;
            double low = 1e9, high = -1e9;
            for (int k = 0; k < 11; ++k)
                for (int j = 0; j < 11; ++j)
                    for (int i = 0; i < 11; ++i) {
                        const double knot = refined(k, [&](int z) {
                            return refined(j, [&](int y) {
                                return refined(i, [&](int x) { return coefficient(x0 + x, y0 + y, z0 + z); });
                            });
                        });
                        low = std::min(low, knot), high = std::max(high, knot);
                    }
            EXPECT_NEAR(bounds.low[cell], low, 0.02) << cell;
            EXPECT_NEAR(bounds.high[cell], high, 0.02) << cell;
        }
    }
}

TEST(Spline, OfEvenMatterIsEven) {
    for (const bool interpolates : {true, false}) {
        const Volume volume =
            sampled<std::uint8_t>({70, 34, 34}, [](double x, double, double) { return x < 20 ? 200 : 7; });
        const DeviceVolume made = splined(upload(tested_device(), volume), interpolates);
        for (const float x : {40.f, 45.3f, 62.1f}) {
            EXPECT_EQ(value_at(made, {x, 12.3f, 31.7f}), 7);
        }
        const CellRanges& cells = made.data().cells;
        const std::size_t last = cells.low.size() - 1;
        EXPECT_EQ(cells.low[last], 7);
        EXPECT_EQ(cells.high[last], 7);
    }
}

TEST(Spline, IsMadeOnceAndTakesOneCopyOfTheBricks) {
    const DeviceVolume voxels = upload(tested_device(), noise<std::uint8_t>(across_bricks));
    const DeviceVolume made = splined(voxels, true);
    EXPECT_EQ(&made.data(), &splined(voxels, true).data());
    EXPECT_NE(&made.data(), &splined(voxels, false).data());
    EXPECT_EQ(made.data().bricks.data(), voxels.data().bricks.data());
    EXPECT_LT(made.bytes() - voxels.data().bricks.size(), 1.35 * double(voxels.data().bricks.size()));
    const DeviceVolume smoothed = splined(voxels, false);
    EXPECT_EQ(smoothed.data().coefficients.data(), voxels.data().bricks.data());
}

// Noise is what normal noise was made with; smooth edges add little, and what a mask leaves of them much.
TEST(Noise, IsMeasuredAsItWasMade) {
    const std::array<int, 3> n{80, 80, 80};
    const auto of = [&](double sigma, double edge) {
        std::mt19937 random(6);
        std::normal_distribution<double> normal(0, 1);
        return measure(sampled<float>(n, [&](double x, double y, double z) {
            const double r = std::hypot(x - 40.3, y - 39.6, z - 40.1);
            const double ball = edge > 0 ? 100 / (1 + std::exp((r - 25) / edge)) : r < 25 ? 100 : 0;
            return ball + sigma * (ball > 4) * normal(random);
        }));
    };
    EXPECT_LT(of(0, 0.4).noise, 0.01);
    EXPECT_LT(of(0, 2).noise, 0.001);
    EXPECT_GT(of(0, 0).noise, worth_smoothing);
    for (const double sigma : {2.0, 4.0, 8.0}) {
        const Statistics found = of(sigma, 2);
        const double made = sigma / (found.p999 - found.p1);
        EXPECT_NEAR(found.noise, 0.9 * made, 0.2 * made) << sigma;  // a little goes with the edge's gradient
    }
}

TEST(Noise, DoesNotDependOnTheUnit) {
    Volume volume = noise<std::int16_t>(across_bricks);
    const double before = measure(volume).noise;
    volume.slope = 0.5, volume.intercept = -20;
    EXPECT_NEAR(measure(volume).noise, before, 1e-12);
    EXPECT_EQ(measure(sampled<std::uint8_t>({2, 9, 9}, [](double x, double, double) { return x; })).noise, 0);
}

TEST(Interpolation, IsChosenByNoiseAndWhatIsThin) {
    std::mt19937 random(7);
    const auto medium = [&](bool is_thin) {
        const Volume volume = sampled<std::uint8_t>({48, 48, 48}, [&](double x, double y, double z) {
            const bool inside = is_thin ? std::fmod(x, 6) == 0 && std::fmod(y, 6) == 0 && z > 4 && z < 43
                                        : std::hypot(x - 24, y - 24, z - 24) < 16;
            return inside ? 200 - int(random() % 30) : 0;
        });
        TransferFunction tf = constant(0.9);
        tf.points = {{120, {1, 1, 1}, 0}, {130, {1, 1, 1}, 0.9}};
        return classify(upload(tested_device(), volume), tf, {});
    };
    EXPECT_EQ(interpolation_for(medium(false), 0.03), Interpolation::smooth);
    EXPECT_EQ(interpolation_for(medium(false), 0.01), Interpolation::cubic);
    EXPECT_EQ(interpolation_for(medium(true), 0.03), Interpolation::cubic);  // keeps .44 of 200
}

TEST(Interpolation, OfAMediumIsThatOfItsShape) {
    const Device device = tested_device();
    const Volume volume =
        sampled<std::uint8_t>({40, 36, 44}, [](double x, double y, double z) { return shells(x, y, z, 42); });
    const DeviceVolume voxels = upload(device, volume);
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic, Interpolation::smooth}) {
        const Medium made = classify(voxels, two_materials(), {.interpolation = interpolation});
        for (const Interpolation before : {Interpolation::linear, Interpolation::smooth}) {
            const Medium other =
                with_interpolation(device, classify(voxels, two_materials(), {.interpolation = before}), interpolation);
            EXPECT_EQ(other.data().cells, made.data().cells);
            EXPECT_EQ(&other.data().volume.data(), &made.data().volume.data());
        }
    }
}

namespace {

/// Between a plane's normal and those that are found where values are half way, RMS: of a mask, 200 or 0 by whether a
/// voxel lies above it.
double angle_deg(const Vec3& normal, const DeviceVolume& mask, bool by_differences) {
    double sum = 0;
    int count = 0;
    const auto view = view_of<std::uint8_t>(mask.data());
    const auto locate = [&](Point p) { return view.locate(p, view.voxel(p)); };
    for (float y = 8; y < 40; y += 0.37f)
        for (float x = 8; x < 40; x += 0.37f) {
            float below = 8, above = 40;
            for (int i = 0; i < 24; ++i) {
                const float z = (below + above) / 2;
                (view.value(locate({x, y, z})) < 100 ? below : above) = z;
            }
            const auto at = locate({x, y, below});
            const Point g = by_differences ? view.differences(at) : view.gradient(at);
            const double cosine = dot(normalized(Vec3{g.x, g.y, g.z}), normal);
            sum += std::pow(std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi, 2), ++count;
        }
    return std::sqrt(sum / count);
}

}  // namespace

// The faces of a mask's voxels were terraces on the brain that the README shows first.
TEST(Interpolation, SmoothNormalsHardlyShowAMasksVoxels) {
    for (const double rise : {0.0, 0.1, 0.2, 0.35}) {
        const Vec3 normal = normalized({-rise, -rise / 3, 1});
        const DeviceVolume mask = splined(
            upload(tested_device(), sampled<std::uint8_t>({48, 48, 48},
                                                          [&](double x, double y, double z) {
                                                              return dot(normal, Vec3{x, y, z - 14}) > 0 ? 200 : 0;
                                                          })),
            false);
        const double found = angle_deg(normal, mask, false), of_one_voxel = angle_deg(normal, mask, true);
        if (std::getenv("CHIARO_SHOW")) fmt::print("rise {}: {:.2f} for {:.2f} degrees\n", rise, found, of_one_voxel);
        EXPECT_LT(found, 0.6 * of_one_voxel + 0.01) << rise;
    }
}

// Of a single look: bricks in which nothing is seen go, of coefficients and of the voxels that they were made of. Some
// end where a brick does, beyond which normals may look.
TEST(Unseen, OfASplineChangesNoBit) {
    for (const auto& [interpolation, thickness] :
         {std::pair{Interpolation::cubic, 1.0}, {Interpolation::smooth, 1.0}, {Interpolation::cubic, 4.0}}) {
        Shot shot;
        shot.shape.interpolation = interpolation;
        shot.lighting.shading = Shading::phong;
        shot.tf.points = {{35, {1, 1, 1}, 0}, {40, {1, 1, 1}, 0.2}, {255, {1, 1, 1}, 0.2}};
        Volume volume = sampled<std::uint8_t>(
            {100, 70, 65}, [](double x, double y, double z) { return x > 20 && x < 31 && y + z < 9 ? 210 : 30; });
        volume.geometry.spacing_mm.z = thickness;
        const DeviceVolume voxels = upload(shot.device, volume);
        const Medium medium = classify(voxels, shot.tf, shot.shape);
        Progress progress;
        const auto drawn = [&] {
            Frame frame(shot.width, shot.height);
            raycast(shot.device, medium, {}, shot.lighting, make_camera({}, voxels.geometry(), voxels.dimensions()),
                    shot.rays, frame, progress);
            return frame;
        };
        const Frame before = drawn();
        EXPECT_GT(mean_alpha(before), 0.001);
        discard_unseen(medium);
        EXPECT_EQ(difference(drawn(), before, 0).max, 0) << to_text(interpolation);
        const DeviceVolume::Data& data = medium.data().volume.data();
        for (const VoxelBuffer* buffer : {&data.coefficients, &data.bricks, &voxels.data().bricks})
            EXPECT_GT(std::count(buffer->data(), buffer->data() + buffer->size(), std::byte(0)),
                      0.9 * double(buffer->size()))
                << to_text(interpolation);
    }
}
