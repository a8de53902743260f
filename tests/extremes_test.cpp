// The ends of numbers: of doubles as values, of spacings, of lengths in steps, of extinction. Where a loop would never
// end the test does not either; nothing here takes a second.
#include <chiaro/chiaro.h>

#include <cmath>
#include <limits>

namespace chiaro {
namespace {

constexpr double most = std::numeric_limits<double>::max();

Volume volume_of(std::array<int, 3> dimensions, Vec3 spacing_mm) {
    Volume volume = make_volume(dimensions, VoxelType::u8);
    volume.source = "v";
    volume.geometry.spacing_mm = spacing_mm;
    const auto voxels = volume.as<std::uint8_t>();
    for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::uint8_t(37 * i);
    return volume;
}

Volume doubles(const std::vector<double>& values, double slope = 1, double intercept = 0) {
    Volume volume = make_volume({int(values.size()), 1, 1}, VoxelType::f64);
    volume.source = "v";
    volume.slope = slope, volume.intercept = intercept;
    std::ranges::copy(values, volume.as<double>().begin());
    return volume;
}

Image picture_of(Volume volume, Scene scene, const Device& device = Device::cpu(2)) {
    Session session(device);
    Progress progress;
    scene.width = scene.height = 16;
    session.show(std::move(volume), progress);
    return session.render(scene, progress);
}

std::string refusal(const std::function<void()>& act) {
    try {
        act();
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

TEST(Extremes, StatisticsToTheEndsOfDouble) {
    std::vector<double> values{-most};
    for (int i = 0; i < 98; ++i) values.push_back((i - 48.5) / 48.5 * (most / 2));
    values.push_back(most);
    const Statistics s = measure(doubles(values));
    EXPECT_EQ(s.min, -most);
    EXPECT_EQ(s.max, most);
    EXPECT_NEAR(s.p50 / most, 0, 0.02);
    EXPECT_EQ(s.p999, most);
    EXPECT_EQ(s.histogram[0], 1u);
    EXPECT_EQ(s.histogram[255], 1u);
    std::uint64_t middle = 0;
    for (int i = 64; i <= 192; ++i) middle += s.histogram[std::size_t(i)];
    EXPECT_EQ(middle, 98u);
}

TEST(Extremes, StatisticsOfTheSmallestDoubles) {
    constexpr double least = std::numeric_limits<double>::denorm_min();
    std::vector<double> values;
    for (int i = 0; i < 101; ++i) values.push_back(i * least);
    const Statistics s = measure(doubles(values));
    EXPECT_EQ(s.min, 0);
    EXPECT_EQ(s.max, 100 * least);
    EXPECT_EQ(s.p50, 50 * least);
    EXPECT_EQ(measure(doubles({most, most})).max, most);
}

TEST(Extremes, ValuesThatAreNotFiniteAreOneSentence) {
    const std::string sentence =
        "v: the slope 1e+308 and the intercept 0 make values of its voxels that are not finite";
    const Volume volume = doubles({0, 100}, 1e308);
    EXPECT_EQ(refusal([&] { measure(volume); }), sentence);
    EXPECT_EQ(refusal([&] { upload(Device::cpu(1), volume); }), sentence);
    Scene scene;
    scene.transfer.source = "gray";
    EXPECT_EQ(picture_of(doubles({0, 100}, 0, 5), scene).width, 16) << "one value everywhere";
}

// Values times a power of two are the same picture, as far as doubles go.
TEST(Extremes, PicturesToTheEndsOfDouble) {
    std::vector<double> values;
    for (int i = 0; i < 40; ++i) values.push_back(i % 7 - 3);
    for (const Mode mode : {Mode::dvr, Mode::mip}) {
        Scene scene;
        scene.mode = mode;
        scene.transfer.source = "viridis";
        const Image plain = picture_of(doubles(values), scene);
        for (const double scale : {0.3 * most, 0x1p1022, 0x1p-1040}) {
            std::vector<double> scaled = values;
            for (double& value : scaled) value *= scale;
            const Image image = picture_of(doubles(scaled), scene);
            int differs = 0;
            for (std::size_t i = 0; i < plain.pixels.size(); ++i)
                differs = std::max(differs, std::abs(plain.pixels[i] - image.pixels[i]));
            EXPECT_LE(differs, 1) << scale << to_text(mode);
        }
    }
}

TEST(Extremes, UploadChecksWhatAProgramMade) {
    const auto upload_with = [](Vec3 spacing_mm) {
        return refusal([&] { upload(Device::cpu(1), volume_of({2, 2, 2}, spacing_mm)); });
    };
    EXPECT_EQ(upload_with({1, 1, 1}), "");
    EXPECT_EQ(upload_with({1, 0, 1}), "v has a spacing (1, 0, 1) that is not positive");
    EXPECT_EQ(upload_with({1, std::nan(""), 1}), "v has a spacing (1, nan, 1) that is not positive");
    Volume volume = volume_of({2, 2, 2}, {1, 1, 1});
    volume.dimensions[2] = 3;
    EXPECT_EQ(refusal([&] { upload(Device::cpu(1), volume); }), "v has fewer voxels than it states");
}

// Along a needle: 10^11 steps, of which floats count 2^24.
TEST(Extremes, RaysOfManyStepsEnd) {
    for (const Mode mode : {Mode::dvr, Mode::iso, Mode::mip}) {
        Scene scene;
        scene.mode = mode;
        scene.iso = {{1000}};
        scene.sampling.step_voxels = 0.001;
        scene.sampling.skip_empty = false;
        scene.illumination.method = Method::none;
        scene.transfer.source = "gray";
        scene.transfer.opacity_scale = 1e-9;
        scene.camera.projection = Projection::orthographic;
        scene.camera.azimuth_deg = 0, scene.camera.elevation_deg = 0;
        scene.width = scene.height = 17;  // the ray in the middle meets it
        Session session(Device::cpu(1));
        Progress progress;
        session.show(volume_of({64, 1, 1}, {1, 1e-6, 1e-6}), progress);
        session.render(scene, progress);
        EXPECT_GT(session.render_statistics().samples, 1u << 22) << to_text(mode);
        EXPECT_LT(session.render_statistics().samples, 1u << 25) << to_text(mode);
    }
}

// In matter so dense a path's free way is shorter than what floats tell apart.
TEST(Extremes, PathsThroughTheDensestMatterEnd) {
    for (const double spacing : {1.0, 1e6})
        for (const double unit_mm : {1e-6, 1e-300}) {
            Scene scene;
            scene.illumination.method = Method::reference;
            scene.illumination.reference.rays = 2;
            scene.transfer.source = "gray";
            scene.transfer.opacity_unit_mm = unit_mm;
            EXPECT_EQ(picture_of(volume_of({8, 8, 8}, {spacing, 1, 1}), scene).width, 16) << unit_mm;
        }
}

// Tiles of 32³ cells halved five times: 2³, 1. Vectors wrote behind their ends.
TEST(Extremes, LightOfLongVolumesIsTheSameForAllLanes) {
    Scene scene;
    scene.illumination.method = Method::transport;
    scene.illumination.transport.grid = 16;
    scene.transfer.source = "gray";
    const Image image = picture_of(volume_of({1, 1, 3000}, {1, 1, 1}), scene),
                scalar = picture_of(volume_of({1, 1, 3000}, {1, 1, 1}), scene, Device::cpu(2, Isa::scalar));
    EXPECT_EQ(image.pixels, scalar.pixels);
}

}  // namespace
}  // namespace chiaro
