// Slices, regions and places on surfaces of a volume by bricks: those of the volume as a whole.
#include <chiaro/chiaro.h>
#include <chiaro/zarr.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <random>

using namespace chiaro;

namespace {

/// A ball with noise, in an oblique, anisotropic grid.
Volume ball(std::array<int, 3> n = {97, 80, 66}) {
    Volume volume = make_volume(n, VoxelType::u16);
    std::mt19937 random(7);
    std::size_t i = 0;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x, ++i) {
                const double r = std::hypot(x - 48.0, y - 40.0, 1.5 * (z - 33.0));
                volume.as<std::uint16_t>()[i] =
                    std::uint16_t(20000 * std::clamp(30.5 - r, 0.0, 1.0)) + std::uint16_t(random() % 32);
            }
    volume.slope = 0.5, volume.intercept = -1000;
    volume.geometry.spacing_mm = {0.7, 0.7, 1.05};
    volume.geometry.origin_mm = {12, -30, 5};
    const Vec3 x = normalized({1, 0.2, 0.1}), z = normalized(cross(x, {0, 1, 0.3}));
    volume.geometry.direction = {x, cross(z, x), z};
    return volume;
}

struct PagedValues : ::testing::Test {
    Progress progress{};
    DeviceVolume whole = upload(Device::cpu(2), ball());
    std::shared_ptr<const BrickSource> source = source_of(ball());
    DeviceVolume coarse = upload(Device::cpu(2), read_level(*source, int(source->levels().size()) - 1, progress));
    Geometry geometry = ball().geometry;

    SlicePlane plane(Vec3 right, Vec3 down, int width, int height, Vec3 centre = {48.2, 39.3, 33.2}) const {
        return {geometry.world_from_voxel(centre), geometry.world_from_voxel_vector(right),
                geometry.world_from_voxel_vector(down), width, height};
    }
    void expect_equal(const SlicePlane& plane, SliceSampling sampling, bool finest = true) {
        const Slice a = slice(*source, coarse, plane, sampling, finest, progress), b = slice(whole, plane, sampling);
        ASSERT_EQ(a.values.size(), b.values.size());
        int inside = 0;
        for (std::size_t i = 0; i < a.values.size(); ++i) {
            ASSERT_EQ(std::isnan(a.values[i]), std::isnan(b.values[i])) << i;
            if (std::isnan(a.values[i])) continue;
            // Places are found from another origin.
            ASSERT_NEAR(a.values[i], b.values[i], sampling == SliceSampling::nearest ? 0 : 1e-6) << i;
            ++inside;
        }
        EXPECT_GT(inside, 0);
    }
};

}  // namespace

TEST_F(PagedValues, SlicesAreThoseOfTheWhole) {
    for (const SliceSampling sampling : {SliceSampling::nearest, SliceSampling::linear}) {
        expect_equal(plane({1, 0, 0}, {0, 1, 0}, 97, 80), sampling);
        expect_equal(plane({0, 0.3107, 0}, {0, 0, 0.2903}, 301, 300), sampling);
        expect_equal(plane({0.9, 0.3, 0.2}, {-0.1, 0.5, 0.8}, 150, 140), sampling);
        expect_equal(plane({1, 0, 0}, {0, 1, 0}, 1, 1, {96.4, 79.4, 65.4}), sampling);
    }
    const Slice outside = slice(*source, coarse, plane({1, 0, 0}, {0, 1, 0}, 5, 5, {48, 40, 200}), {}, true, progress);
    for (const double v : outside.values) EXPECT_TRUE(std::isnan(v));
}

/// Of pixels as large as its voxels a coarser level is read, unless the finest is asked for.
TEST_F(PagedValues, TheLevelOfASliceIsThatOfItsPixels) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("chiaro-paged-values-{}.nrrd", getpid());
    Volume plain = ball();
    plain.slope = 1, plain.intercept = 0;
    write_nrrd(plain, file, NrrdEncoding::raw);
    whole = upload(Device::cpu(2), plain);
    source = open_brick_source(file, {});
    std::filesystem::remove(file);
    const SlicePlane wide = plane({2, 0, 0}, {0, 2, 0}, 40, 30), tall = plane({2, 0, 0}, {0, 1.5, 0}, 40, 30);
    ASSERT_GE(source->levels().size(), 2u);
    const DeviceVolume half = upload(Device::cpu(2), read_level(*source, 1, progress));
    const Slice a = slice(*source, coarse, wide, {}, false, progress), b = slice(half, wide, {});
    for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1e-6);
    expect_equal(wide, SliceSampling::nearest, true);
    expect_equal(tall, SliceSampling::nearest, false);
}

/// Wide pixels of an oblique plane, in pieces.
TEST(PagedSlices, ALargeVolumeIsReadInPieces) {
    Progress progress;
    const auto source = open_sample("shells", 1024);
    const DeviceVolume coarse = upload(Device::cpu(2), read_level(*source, 4, progress));
    const Geometry& g = source->header().geometry;
    const SlicePlane plane{g.world_from_voxel({511, 512, 510}), g.world_from_voxel_vector({30, 7, 9}),
                           g.world_from_voxel_vector({-6, 21, 17}), 24, 24};
    const Slice seen = slice(*source, coarse, plane, SliceSampling::nearest, true, progress);
    for (int row = 0; row < plane.height; ++row)
        for (int column = 0; column < plane.width; ++column) {
            const Vec3 p = g.voxel_from_world(plane.at(column, row));
            VoxelBox box{{0, 0, 0}, {1, 1, 1}};
            bool is_inside = true;
            for (int axis = 0; axis < 3; ++axis) {
                box.first[std::size_t(axis)] = int(std::floor(p[axis] + 0.5));
                is_inside = is_inside && p[axis] >= -0.5 && p[axis] < 1023.5;
            }
            const double value = seen.values[std::size_t(row * plane.width + column)];
            ASSERT_EQ(std::isnan(value), !is_inside);
            if (!is_inside) continue;
            std::byte voxel{};
            source->read(0, box, &voxel);
            ASSERT_EQ(value, double(voxel)) << row << " " << column;
        }
    Progress cancelled;
    cancelled.cancel();
    EXPECT_THROW(slice(*source, coarse, plane, {}, true, cancelled), Error);
}

TEST_F(PagedValues, RegionsAreThoseOfTheWhole) {
    const Vec3 centre = geometry.world_from_voxel({70, 42, 30});
    const Region regions[] = {BallRegion{centre, 9}, BallRegion{geometry.world_from_voxel({95, 2, 60}), 14},
                              BoxRegion{centre, geometry.world_from_voxel({12, 7, 61})}};
    for (const Region& region : regions) {
        const RegionValues a = measure(*source, coarse, region, progress), b = measure(whole, region, progress);
        EXPECT_EQ(a.count, b.count);
        EXPECT_EQ(a.mean, b.mean);
        EXPECT_EQ(a.deviation, b.deviation);
        EXPECT_EQ(a.percentiles, b.percentiles);
        EXPECT_EQ(a.histogram, b.histogram);
        EXPECT_NEAR(a.exact_mm3, b.exact_mm3, 1e-9);
    }
    for (const Vec3 far : {Vec3{1e6, 0, 0}, Vec3{-400, 2, 3}})
        EXPECT_THROW(measure(*source, coarse, BallRegion{far, 2}, progress), Error);
}

TEST_F(PagedValues, PlacesOnSurfacesAreThoseOfTheWhole) {
    for (int i = 0; i < 40; ++i) {
        const double a = 0.7 * i, h = std::sin(1.3 * i);
        const double r = 30 + 1.5 * std::sin(2.1 * i);
        const Vec3 at = geometry.world_from_voxel({48 + r * std::cos(a) * std::sqrt(1 - h * h),
                                                   40 + r * std::sin(a) * std::sqrt(1 - h * h), 33 + r * h / 1.5});
        const auto one = snap_to_surface(*source, coarse, at, 3), other = snap_to_surface(whole, at, 3);
        ASSERT_EQ(one.has_value(), other.has_value()) << i;
        if (one) EXPECT_LT(length(*one - *other), 1e-9) << i;
    }
    EXPECT_FALSE(snap_to_surface(*source, coarse, geometry.world_from_voxel({48, 40, 33}), 2)) << "noise is no surface";
    EXPECT_FALSE(snap_to_surface(*source, coarse, {1e6, 0, 0}, 2));
}
