// Regions and gradients against brute force and closed forms; places on surfaces of known size.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

using namespace chiaro;

namespace {

Geometry oblique() {
    Geometry g;
    g.spacing_mm = {0.7, 1.1, 2.3}, g.origin_mm = {12, -30, 5};
    const Vec3 x = normalized({1, 0.2, 0.1}), z = normalized(cross(x, {0, 1, 0.3}));
    g.direction = {x, cross(z, x), z};
    return g;
}

Volume noise() {
    Volume v = make_volume({23, 19, 17}, VoxelType::i16);
    std::mt19937 random(3);
    for (auto& voxel : v.as<std::int16_t>()) voxel = std::int16_t(random());
    v.slope = 0.37, v.intercept = -1000.3, v.geometry = oblique();
    return v;
}

/// What numpy computes of the sorted values in float64.
void expect_numpys(const RegionValues& told, std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto n = values.size();
    ASSERT_EQ(told.count, n);
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(n);
    double squares = 0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    const auto close = [](double a, double b) { EXPECT_NEAR(a, b, 1e-9 * std::max(1.0, std::abs(b))); };
    close(told.mean, mean), close(*told.deviation, std::sqrt(squares / double(n - 1)));
    EXPECT_EQ(told.min, values.front());
    EXPECT_EQ(told.max, values.back());
    for (std::size_t i = 0; i < told.shares.size(); ++i) {
        const double at = told.shares[i] * double(n - 1);
        const auto low = std::size_t(at), high = std::min(low + 1, n - 1);
        close(told.percentiles[i], values[low] + (at - double(low)) * (values[high] - values[low]));
    }
    EXPECT_EQ(std::accumulate(told.histogram.begin(), told.histogram.end(), std::uint64_t(0)), n);
}

template <class IsIn>
std::vector<double> values_where(const Volume& v, const IsIn& is_in) {
    std::vector<double> values;
    for (int k = 0, at = 0; k < v.dimensions[2]; ++k)
        for (int j = 0; j < v.dimensions[1]; ++j)
            for (int i = 0; i < v.dimensions[0]; ++i, ++at)
                if (is_in(Vec3{double(i), double(j), double(k)}))
                    values.push_back(v.slope * v.as<std::int16_t>()[std::size_t(at)] + v.intercept);
    return values;
}

DeviceVolume sample(const std::string& name, int size, Geometry g = {}) {
    Volume v = make_sample(name, size);
    v.geometry = g;
    return upload(Device::cpu(2), v);
}

}  // namespace

TEST(Measuring, ABallHoldsTheVoxelsWhoseCentresLieInIt) {
    const Volume v = noise();
    const DeviceVolume device = upload(Device::cpu(2), v);
    Progress progress;
    for (const double radius : {0.8, 3.0, 7.5, 100.0}) {
        const BallRegion ball{v.geometry.world_from_voxel({11.2, 9.4, 8.1}), radius};
        const RegionValues told = measure(device, ball, progress);
        expect_numpys(told, values_where(v, [&](Vec3 p) {
                          return length(v.geometry.world_from_voxel(p) - ball.centre_mm) <= radius;
                      }));
        EXPECT_NEAR(told.volume_mm3, double(told.count) * 0.7 * 1.1 * 2.3, 1e-9 * told.volume_mm3);
        EXPECT_NEAR(told.exact_mm3, 4.18879020478639 * radius * radius * radius, 1e-9 * told.exact_mm3);
    }
}

TEST(Measuring, ABoxRunsAlongTheVolumesAxesRimIncluded) {
    const Volume v = noise();
    const DeviceVolume device = upload(Device::cpu(1), v);
    Progress progress;
    const Geometry& g = v.geometry;
    const BoxRegion box{g.world_from_voxel({3, 12.5, 2}), g.world_from_voxel({9, 4, 2})};
    const RegionValues told = measure(device, box, progress);
    EXPECT_EQ(told.count, 7u * 9u * 1u);
    expect_numpys(told,
                  values_where(v, [](Vec3 p) { return p.x >= 3 && p.x <= 9 && p.y >= 4 && p.y <= 12.5 && p.z == 2; }));
    const RegionValues all =
        measure(device, BoxRegion{g.world_from_voxel({-50, -50, -50}), g.world_from_voxel({99, 99, 99})}, progress);
    EXPECT_EQ(all.count, v.voxel_count());
}

TEST(Measuring, OneVoxelHasNoDeviationAndNoneIsASentence) {
    const Volume v = noise();
    const DeviceVolume device = upload(Device::cpu(1), v);
    Progress progress;
    const RegionValues one = measure(device, BallRegion{v.geometry.world_from_voxel({4, 4, 4}), 0.3}, progress);
    EXPECT_EQ(one.count, 1u);
    EXPECT_FALSE(one.deviation);
    EXPECT_EQ(one.percentiles[3], one.mean);
    const auto refused = [&](const Region& region, const char* sentence) {
        try {
            measure(device, region, progress);
            ADD_FAILURE() << sentence;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage);
            EXPECT_STREQ(error.what(), sentence);
        }
    };
    refused(BallRegion{v.geometry.world_from_voxel({4.5, 4.5, 4.5}), 0.1}, "region: no voxel's centre lies in it");
    refused(BallRegion{{1e6, 0, 0}, 1}, "region: no voxel's centre lies in it");
    refused(BallRegion{{0, 0, 0}, 0}, "region: the ball's radius must be above 0");
    refused(BallRegion{{NAN, 0, 0}, 1}, "region: must be of finite numbers");
    refused(BoxRegion{{0, 0, INFINITY}, {1, 1, 1}}, "region: must be of finite numbers");
}

TEST(Measuring, SnapsToTheBallWithinATenthOfAVoxel) {
    constexpr int size = 96;
    const Vec3 centre{(size - 1) / 2.0, (size - 1) / 2.0, (size - 1) / 2.0};
    constexpr double radius = 0.375 * size;
    for (const bool is_oblique : {false, true}) {
        Geometry g;
        if (is_oblique) g = oblique(), g.spacing_mm = {0.5, 0.5, 0.5};
        const DeviceVolume ball = sample("ball", size, g);
        std::mt19937 random(5);
        std::normal_distribution<double> normal;
        double worst = 0, beside = 0;
        for (int i = 0; i < 100; ++i) {
            const Vec3 out = normalized({normal(random), normal(random), normal(random)});
            const double off = -2.5 + 5.0 * i / 99;
            const auto on =
                snap_to_surface(ball, g.world_from_voxel(centre + (radius + off) * out), 3 * g.spacing_mm.x);
            ASSERT_TRUE(on) << off;
            const Vec3 p = g.voxel_from_world(*on);
            worst = std::max(worst, std::abs(length(p - centre) - radius));
            beside = std::max(beside, length(p - (centre + radius * out)));
        }
        EXPECT_LT(worst, 0.1);
        EXPECT_LT(beside, 0.25);  // of the nearest place, from up to 2.5 voxels away
        EXPECT_FALSE(snap_to_surface(ball, g.world_from_voxel(centre), 3));
        EXPECT_FALSE(
            snap_to_surface(ball, g.world_from_voxel(centre + (radius + 5) * Vec3{1, 0, 0}), 3 * g.spacing_mm.x));
    }
}

TEST(Measuring, SnapsToBothFacesOfTheSlabAndToATube) {
    constexpr int size = 64;
    const DeviceVolume slab = sample("slab", size);
    for (const double off : {-2.0, -0.7, 0.0, 0.4, 1.9}) {
        const auto low = snap_to_surface(slab, {30.2, 20.1, 0.25 * size - 0.5 + off}, 3);
        const auto high = snap_to_surface(slab, {30.2, 20.1, 0.75 * size - 0.5 + off}, 3);
        ASSERT_TRUE(low && high);
        EXPECT_NEAR(high->z - low->z, size / 2.0, 0.1);
        EXPECT_NEAR(low->x, 30.2, 0.05);
        EXPECT_NEAR(low->y, 20.1, 0.05);
    }
    constexpr int n =
        128;  // the outer wall of the tube about y .42, z .30: radius .19, at the top where air is beside it
    const DeviceVolume tubes = sample("tubes", n);
    for (const double angle : {0.3, 0.8, 1.4, 2.0, 2.9}) {
        const double y = 0.42 + 0.19 * std::cos(angle), z = 0.30 + 0.19 * std::sin(angle);
        const auto on = snap_to_surface(tubes, {0.45 * n, y * n - 0.5 + 0.6, z * n - 0.5 + 0.6}, 3);
        ASSERT_TRUE(on) << angle;
        const double r = std::hypot((on->y + 0.5) / n - 0.42, (on->z + 0.5) / n - 0.30);
        EXPECT_NEAR(r * n, 0.19 * n, 0.1) << angle;
    }
}

TEST(Measuring, WithinAPlaneItStaysThere) {
    constexpr int size = 64;
    const DeviceVolume ball = sample("ball", size);
    const Vec3 centre{31.5, 31.5, 31.5};
    constexpr double height = 14, radius = 0.375 * size;
    const double there = std::sqrt(radius * radius - height * height);
    const auto on = snap_to_surface(ball, centre + Vec3{there + 1.2, 0.5, height}, 3, Vec3{0, 0, 2});
    ASSERT_TRUE(on);
    EXPECT_NEAR(on->z, centre.z + height, 1e-9);
    EXPECT_NEAR(std::hypot(on->x - centre.x, on->y - centre.y), there, 0.1);
}

TEST(Measuring, MarksAndSlicesOfASceneComeBack) {
    Scene scene = scene_of_volume("sample:ball");
    scene.marks = {{MarkKind::angle, {{0.1, 2, 3}, {4, 5, 6}, {7, 8, 1e-7}}, "θ"},
                   {MarkKind::text, {{1, 2, 3}}, "here"}};
    scene.slices.layout = SliceLayout::linked, scene.slices.at_mm = Vec3{1.5, -2, 3};
    scene.slices.window = {40, 400}, scene.slices.side = SliceSide::neurological, scene.slices.outlines = false;
    std::vector<std::string> unknown;
    const Scene again = parse_scene(to_json(scene), {}, {}, unknown);
    EXPECT_EQ(again.marks, scene.marks);
    EXPECT_EQ(again.slices, scene.slices);
    EXPECT_TRUE(unknown.empty());
    EXPECT_EQ(to_json(scene_of_volume("sample:ball")).find("slices"), std::string::npos);
    for (const char* wrong :
         {R"([{"kind": "angle", "points": [[1, 2, 3]]}])", R"([{"kind": "ruler"}])", R"({})", R"([3])",
          R"([{"kind": "text", "points": [[1, 2, "3"]]}])", R"([{"kind": "text", "points": [[1, 2]]}])",
          R"([{"kind": "text", "points": [[1, 2, 3]], "text": 7}])"})
        EXPECT_THROW(
            parse_scene(std::string(R"({"chiaro": 1, "volume": {"file": "sample:ball"}, "marks": )") + wrong + "}", {},
                        {}, unknown),
            Error)
            << wrong;
}

namespace {

/// Of every voxel its value and the magnitude of its gradient, in double precision.
template <class T>
std::vector<std::pair<double, double>> values_and_magnitudes(const Volume& v) {
    const auto [nx, ny, nz] = v.dimensions;
    const auto at = [&](int i, int j, int k) {
        const auto index = [](int c, int n) { return std::size_t(std::clamp(c, 0, n - 1)); };
        return v.slope *
                   double(v.as<T>()[(index(k, nz) * std::size_t(ny) + index(j, ny)) * std::size_t(nx) + index(i, nx)]) +
               v.intercept;
    };
    std::vector<std::pair<double, double>> found;
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                const Vec3 g{at(i + 1, j, k) - at(i - 1, j, k), at(i, j + 1, k) - at(i, j - 1, k),
                             at(i, j, k + 1) - at(i, j, k - 1)};
                Vec3 world;
                for (int axis = 0; axis < 3; ++axis) {
                    Vec3 along;
                    along[axis] = 1;
                    world[axis] = 0.5 * dot(v.geometry.voxel_from_world_vector(along), g);
                }
                found.emplace_back(at(i, j, k), length(world));
            }
    return found;
}

/// The same counts, but for voxels that rounding to float may have taken over the border of a row.
template <class T>
void expect_counts(const Volume& v, int columns, int rows) {
    Progress progress;
    const GradientHistogram told = gradient_histogram(upload(Device::cpu(2), v), columns, rows, progress);
    const auto all = values_and_magnitudes<T>(v);
    const auto [least, most] = std::minmax_element(all.begin(), all.end());
    EXPECT_NEAR(told.value_low, least->first, 1e-9 * std::abs(least->first));
    EXPECT_NEAR(told.value_high, most->first, 1e-9 * std::abs(most->first));
    double steepest = 0;
    for (const auto& [value, magnitude] : all) steepest = std::max(steepest, magnitude);
    EXPECT_NEAR(told.steepest, steepest, 1e-5 * steepest);
    ASSERT_EQ(told.rows, rows);
    std::vector<std::uint64_t> expected(std::size_t(told.columns) * std::size_t(rows));
    for (const auto& [value, magnitude] : all) {
        const auto bin = [](double share, int bins) {
            return std::size_t(std::min(int(share * bins + 1e-9), bins - 1));
        };
        ++expected[bin(std::sqrt(magnitude / steepest), rows) * std::size_t(told.columns) +
                   bin((value - told.value_low) / (told.value_high - told.value_low), told.columns)];
    }
    std::uint64_t moved = 0, sum = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        moved += told.counts[i] > expected[i] ? told.counts[i] - expected[i] : 0;
        sum += told.counts[i];
    }
    EXPECT_EQ(sum, v.voxel_count());
    EXPECT_LE(moved, v.voxel_count() / 1000);
}

}  // namespace

TEST(GradientHistogram, CountsEveryVoxelAsBruteForceDoes) {
    expect_counts<std::int16_t>(noise(), 256, 128);
    Volume falling = noise();
    falling.slope = -0.37;
    expect_counts<std::int16_t>(falling, 100, 1);
    for (const std::array<int, 3> n : {std::array{1, 1, 1}, {2, 1, 33}, {34, 35, 3}, {64, 33, 66}}) {
        Volume v = make_volume(n, VoxelType::f32);
        v.geometry = oblique();
        std::mt19937 random(5);
        for (float& voxel : v.as<float>()) voxel = std::uniform_real_distribution<float>(-3, 9)(random);
        if (v.voxel_count() > 1) expect_counts<float>(v, 64, 200);
    }
}

TEST(GradientHistogram, AnEvenRampLiesInOneRowAndWholeNumbersHaveAColumnEach) {
    Volume v = make_volume({40, 8, 9}, VoxelType::u8);
    v.geometry.spacing_mm = {0.5, 1, 2};
    for (std::size_t i = 0; i < v.voxel_count(); ++i) v.as<std::uint8_t>()[i] = std::uint8_t(10 + i % 40);
    Progress progress;
    const GradientHistogram told = gradient_histogram(upload(Device::cpu(1), v), 256, 10, progress);
    EXPECT_EQ(told.columns, 40);
    EXPECT_EQ(told.value_low, 10);
    EXPECT_EQ(told.value_high, 49);
    EXPECT_DOUBLE_EQ(told.steepest, 2);  // one in .5 mm
    for (int column = 0; column < 40; ++column) {
        // At the two ends half of it: a row that begins at .98 and holds 1.
        const int row = column == 0 || column == 39 ? 7 : 9;
        EXPECT_EQ(told.counts[std::size_t(row * 40 + column)], 72u) << column;
    }
    EXPECT_DOUBLE_EQ(told.magnitude_of(7), 0.98);
}

TEST(GradientHistogram, NothingToTellApartAndTooManyBins) {
    const DeviceVolume one = upload(Device::cpu(1), make_volume({5, 4, 3}, VoxelType::u16));
    Progress progress;
    const GradientHistogram even = gradient_histogram(one, 8, 4, progress);
    EXPECT_EQ(even.columns, 1);
    EXPECT_EQ(even.steepest, 0);
    EXPECT_EQ(even.counts[0], 60u);
    EXPECT_THROW(gradient_histogram(one, 0, 4, progress), Error);
    EXPECT_THROW(gradient_histogram(one, 8, 1025, progress), Error);
    progress.cancel();
    EXPECT_THROW(gradient_histogram(one, 8, 4, progress), Error);
}
