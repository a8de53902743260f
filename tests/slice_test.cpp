// Slices against the voxels themselves and against closed forms.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

using namespace chiaro;

namespace {

/// Random bits of a type, in an oblique, anisotropic grid.
template <class T>
Volume noise(std::array<int, 3> n, double slope = 1, double intercept = 0) {
    Volume volume = make_volume(n, voxel_type_of<T>());
    std::mt19937 random(7);
    for (T& v : volume.as<T>()) {
        if constexpr (std::is_floating_point_v<T>)
            v = T(std::ldexp(double(random()), -20) - 1000);
        else
            v = T(random());
    }
    volume.slope = slope, volume.intercept = intercept;
    volume.geometry.spacing_mm = {0.7, 1.1, 2.3};
    volume.geometry.origin_mm = {12, -30, 5};
    const Vec3 x = normalized({1, 0.2, 0.1}), z = normalized(cross(x, {0, 1, 0.3}));
    volume.geometry.direction = {x, cross(z, x), z};
    return volume;
}

template <class T>
double file_value(const Volume& v, int i, int j, int k) {
    return v.slope * double(v.as<T>()[(std::size_t(k) * v.dimensions[1] + j) * v.dimensions[0] + i]) + v.intercept;
}

/// One voxel a pixel across an axis, row 0 and column 0 at voxel 0.
SlicePlane across(const Volume& v, int axis, int index) {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    Vec3 middle, right, down;
    middle[axis] = index, middle[a] = 0.5 * (v.dimensions[a] - 1), middle[b] = 0.5 * (v.dimensions[b] - 1);
    right[a] = 1, down[b] = 1;
    const Geometry& g = v.geometry;
    return {g.world_from_voxel(middle), g.world_from_voxel_vector(right), g.world_from_voxel_vector(down),
            v.dimensions[a], v.dimensions[b]};
}

template <class T>
void expect_the_files_values(double slope, double intercept) {
    const Volume v = noise<T>({37, 35, 34}, slope, intercept);
    const DeviceVolume device = upload(Device::cpu(2), v);
    EXPECT_TRUE(device.is_exact());
    for (int axis = 0; axis < 3; ++axis)
        for (int index : {0, 1, 31, 32, 33}) {
            const Slice seen = slice(device, across(v, axis, index), SliceSampling::nearest);
            const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
            for (int row = 0; row < seen.height; ++row)
                for (int column = 0; column < seen.width; ++column) {
                    std::array<int, 3> at{};
                    at[axis] = index, at[a] = column, at[b] = row;
                    // To the last bit.
                    ASSERT_EQ(seen.values[std::size_t(row) * seen.width + column],
                              file_value<T>(v, at[0], at[1], at[2]))
                        << axis << " " << index << " " << row << " " << column;
                }
        }
}

}  // namespace

TEST(Slice, NearestValuesAreTheFilesToTheLastBit) {
    expect_the_files_values<std::uint8_t>(1, 0);
    expect_the_files_values<std::int8_t>(0.1, -3.7);
    expect_the_files_values<std::uint16_t>(0.1, 0.3);
    expect_the_files_values<std::int16_t>(1, -1024);
    expect_the_files_values<std::int16_t>(1.0 / 3, 7.7);
    expect_the_files_values<float>(0.1, 5);
    EXPECT_FALSE(upload(Device::cpu(1), noise<double>({3, 4, 5})).is_exact());
    EXPECT_FALSE(upload(Device::cpu(1), noise<std::uint32_t>({3, 4, 5})).is_exact());
}

TEST(Slice, ALinearOneIsTrilinearAndEndsHalfAVoxelOutside) {
    Volume v = make_volume({5, 6, 7}, VoxelType::f32);
    const auto f = [](double x, double y, double z) { return 3 * x - 2 * y + z + 0.5 * x * y * z; };
    for (int k = 0, at = 0; k < 7; ++k)
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 5; ++i) v.as<float>()[at++] = float(f(i, j, k));
    v.geometry.spacing_mm = {2, 1, 0.5};
    const DeviceVolume device = upload(Device::cpu(2), v);
    const SlicePlane plane{{3.3, 2.6, 1.4}, {0.31, 0.07, 0.02}, {-0.05, 0.11, 0.06}, 60, 70};
    const Slice seen = slice(device, plane, SliceSampling::linear);
    int inside = 0;
    for (int row = 0; row < 70; ++row)
        for (int column = 0; column < 60; ++column) {
            const Vec3 p = v.geometry.voxel_from_world(plane.at(column, row));
            const double value = seen.values[std::size_t(row) * 60 + column];
            const bool is_in = p.x >= -0.5 && p.x < 4.5 && p.y >= -0.5 && p.y < 5.5 && p.z >= -0.5 && p.z < 6.5;
            const auto on_rim = [](double c) { return std::abs(c - std::floor(c) - 0.5) < 1e-9; };
            if (on_rim(p.x) || on_rim(p.y) || on_rim(p.z)) continue;  // rounding decides
            ASSERT_EQ(std::isnan(value), !is_in);
            if (!is_in) continue;
            ++inside;
            // Within a cell xyz is trilinear itself; beyond the outermost centres these hold.
            const auto held = [](double c, int n) { return std::clamp(c, 0.0, n - 1.0); };
            ASSERT_NEAR(value, f(held(p.x, 5), held(p.y, 6), held(p.z, 7)), 1e-5);
        }
    EXPECT_GT(inside, 500);
}

TEST(Slice, IsTheSameForAnyNumberOfThreadsAndForThinVolumes) {
    const Volume v = noise<std::uint16_t>({40, 1, 9});
    const SlicePlane plane{v.geometry.world_from_voxel({20, 0, 4}), {0.6, 0.1, 0}, {0.1, 0, 0.9}, 50, 30};
    const auto seen = [&](int threads) {
        return slice(upload(Device::cpu(threads), v), plane, SliceSampling::linear).values;
    };
    const auto one = seen(1), two = seen(2);
    EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)), 0);
    EXPECT_FALSE(std::isnan(one[15 * 50 + 25]));
}

TEST(Slice, RefusesPlanesThatAreNone) {
    const DeviceVolume device = upload(Device::cpu(1), make_sample("ball", 8));
    EXPECT_THROW(slice(device, {{}, {1, 0, 0}, {0, 1, 0}, 0, 4}, SliceSampling::linear), Error);
    EXPECT_THROW(slice(device, {{}, {1, 0, 0}, {0, 1, 0}, 1 << 20, 1 << 20}, SliceSampling::linear), Error);
    EXPECT_THROW(slice(device, {{NAN, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4}, SliceSampling::linear), Error);
    const Slice far = slice(device, {{1e300, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4}, SliceSampling::nearest);
    for (const double v : far.values) EXPECT_TRUE(std::isnan(v));
}

/// numpy: np.floor(np.clip((v - low) / (high - low), 0, 1) * 255 + 0.5).
TEST(Slice, ThePictureIsTheLinearMappingOfTheValues) {
    const Volume v = noise<std::uint16_t>({37, 35, 3});
    const DeviceVolume device = upload(Device::cpu(2), v);
    for (const auto sampling : {SliceSampling::nearest, SliceSampling::linear}) {
        const Image image = develop(slice(device, across(v, 2, 1), sampling), SliceTone{0, 65535, {}});
        for (int j = 0; j < 35; ++j)
            for (int i = 0; i < 37; ++i) {
                const double share = file_value<std::uint16_t>(v, i, j, 1) / 65535;
                const int grey = int(std::floor(share * 255 + 0.5));
                for (int c = 0; c < 3; ++c) ASSERT_EQ(int(image.pixels[3 * (std::size_t(j) * 37 + i) + c]), grey);
            }
    }
    EXPECT_THROW(develop(Slice{1, 1, {0}}, SliceTone{5, 5, {}}), Error);
}

TEST(Slice, ColoursLieOverTheGreyByTheirShareOfTheLargestOpacity) {
    TransferFunction tf;
    tf.points = {{0, {1, 0, 0}, 0}, {100, {1, 0, 0}, 0.5}};
    SliceTone tone{0, 200, tf};
    tone.shown_high = 90;
    const Slice values{5, 1, {0, 50, 80, 100, NAN}};
    const Image image = develop(values, tone);
    const std::vector<std::uint8_t> expected{0, 0, 0, 159, 32, 32, 224, 20, 20, 128, 128, 128, 0, 0, 0};
    EXPECT_EQ(image.pixels, expected);  // 50: grey .25 and half red; 100: outside of what is shown
}

TEST(Slice, SectionsFollowTheBodyInAll48Orders) {
    const std::array<Vec3, 3> lps{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    std::array<int, 3> of{0, 1, 2};
    int seen = 0;
    do
        for (int signs = 0; signs < 8; ++signs)
            for (const World world : {World::lps, World::ras}) {
                Geometry g;
                g.world = world;
                const double side = world == World::ras ? -1 : 1;
                for (int a = 0; a < 3; ++a) g.direction[a] = (signs >> a & 1 ? -1.0 : 1.0) * lps[of[a]];
                const auto [axial, coronal, sagittal] = sections_of(g);
                const Vec3 left = side * lps[0], back = side * lps[1], head = lps[2];
                EXPECT_EQ(axial.name, "axial");
                EXPECT_EQ(axial.right, left);
                EXPECT_EQ(axial.down, back);
                EXPECT_EQ(coronal.right, left);
                EXPECT_EQ(coronal.down, -head);
                EXPECT_EQ(sagittal.right, back);
                EXPECT_EQ(sagittal.down, -head);
                EXPECT_EQ(of[axial.axis], 2);
                EXPECT_EQ(of[coronal.axis], 1);
                EXPECT_EQ(of[sagittal.axis], 0);
                ++seen;
            }
    while (std::next_permutation(of.begin(), of.end()));
    EXPECT_EQ(seen, 96);
    const auto unknown = sections_of({});
    EXPECT_EQ(unknown[0].name, "z");
    EXPECT_EQ(unknown[2].axis, 0);
}

/// Labels twice as fine as the volume, in an oblique frame: the number of the voxel that is nearest, 0 beyond.
TEST(Slice, LabelsAreThoseOfTheNearestVoxelWhateverTheirGrid) {
    Volume v = noise<std::uint8_t>({12, 10, 9});
    v.geometry.world = World::lps;
    Volume fine = make_volume({24, 20, 18}, VoxelType::u8);
    for (std::size_t i = 0; i < fine.as<std::uint8_t>().size(); ++i)
        fine.as<std::uint8_t>()[i] = std::uint8_t(i * 7 % 11);
    fine.geometry = v.geometry;
    fine.geometry.spacing_mm = 0.5 * v.geometry.spacing_mm;
    fine.geometry.origin_mm = v.geometry.world_from_voxel({-0.25, -0.25, -0.25});
    Progress progress;
    const LabelVolume labels = make_labels(fine, nullptr, progress);
    const SlicePlane plane = across(v, 2, 4);
    const Vec3 quarter = v.geometry.world_from_voxel_vector({0, 0, 0.25});  // to the middle of a fine voxel
    const SlicePlane half{plane.centre_mm + quarter, 0.5 * plane.right_mm, 0.5 * plane.down_mm, 30, 24};
    const auto numbers = slice(labels, upload(Device::cpu(2), v), half);
    const auto inside = [](int i, int n) { return i >= 0 && i < n; };
    for (int row = 0; row < 24; ++row)
        for (int column = 0; column < 30; ++column) {
            const int x = column - 3, y = row - 2;  // of the fine grid: the picture is three and two voxels wider
            const std::uint16_t expected =
                inside(x, 24) && inside(y, 20)
                    ? labels.numbers()[(std::size_t(9) * 20 + std::size_t(y)) * 24 + std::size_t(x)]
                    : std::uint16_t(0);
            ASSERT_EQ(numbers[std::size_t(row) * 30 + std::size_t(column)], expected) << column << " " << row;
        }
}

TEST(Slice, LabelsLieOverThePictureAndTheirBordersHideIt) {
    Image image{3, 1, false, std::vector<std::uint8_t>(9, 100)};
    const std::vector<Label> looks{
        {.value = 0, .tint = 0}, {.value = 5, .rgb = {1, 0, 0}}, {.value = 6, .show = false}};
    lay_over(image, {1, 1, 1}, looks, 0.5);
    EXPECT_EQ(image.pixels[0], 178);  // 100 + .5 (255 - 100)
    EXPECT_EQ(image.pixels[1], 50);
    Image border{3, 1, false, std::vector<std::uint8_t>(9, 100)};
    lay_over(border, {0, 1, 2}, looks, 0.5);
    EXPECT_EQ(border.pixels, (std::vector<std::uint8_t>{100, 100, 100, 255, 0, 0, 100, 100, 100}));
    EXPECT_THROW(lay_over(border, {0, 1}, looks, 0.5), Error);
}

TEST(Slice, ChannelsAddUpInTheirColours) {
    const Slice one{3, 1, {0, 50, 100}}, two{3, 1, {20, 20, std::nan("")}};
    const Image image = develop({{one, 0, 100, {1, 0, 0}}, {two, 0, 40, {1, 0, 1}}});
    EXPECT_EQ(image.pixels, (std::vector<std::uint8_t>{128, 0, 128, 255, 0, 128, 255, 0, 0}));
    EXPECT_THROW(develop(std::vector<SliceChannel>{}), Error);
    EXPECT_THROW(develop({{one, 5, 5, {1, 0, 0}}}), Error);
}
