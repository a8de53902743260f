// Light from local histograms, from the volume to the picture: what is prepared once and what an edit redoes, the
// cache, colour that bleeds, brightness.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "fixtures.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

Scene scene_of(const HistogramSettings& histogram = {.radius = 8, .clusters = 256, .cache = "none"}) {
    Scene scene;
    scene.volume = "test";
    scene.transfer.points = chiaro::testing::two_materials();
    scene.illumination.method = Method::histogram;
    scene.illumination.histogram = histogram;
    scene.width = 64, scene.height = 48;
    scene.camera.fit = Fit::volume;
    scene.interpolation = Interpolation::linear;  // these are about light
    return scene;
}

Volume soft_shells(int n = 40) {
    return chiaro::testing::sampled<std::uint8_t>(
        {n, n, n}, [n](double x, double y, double z) { return chiaro::testing::shells(x, y, z, n); });
}

Session session_with(Volume volume, const Device& device = tested_device()) {
    Session session(device);
    Progress progress;
    session.show(std::move(volume), progress);
    return session;
}

std::vector<float> image(Session& session, const Scene& scene) {
    Progress progress;
    session.render(scene, progress);
    return session.frame().rgba;
}
std::vector<float> image(Volume volume, const Scene& scene, const Device& device = tested_device()) {
    Session session = session_with(std::move(volume), device);
    return image(session, scene);
}

double seconds_of(const Session& session, const std::string& stage) {
    for (const Stage& s : session.stages())
        if (s.name == stage) return s.seconds;
    return -1;
}

double mean(const std::vector<float>& rgba, std::size_t channel) {
    double sum = 0;
    for (std::size_t i = channel; i < rgba.size(); i += 4) sum += rgba[i];
    return sum / (double(rgba.size()) / 4);
}

TEST(HistogramLight, IsPreparedOncePerVolume) {
    Session session = session_with(soft_shells());
    Scene scene = scene_of();
    image(session, scene);
    EXPECT_GT(seconds_of(session, "prepare"), 0);
    EXPECT_GT(seconds_of(session, "histograms"), 0);
    scene.transfer.points->points[1].opacity = 0.4;
    image(session, scene);
    EXPECT_EQ(seconds_of(session, "prepare"), 0);
    EXPECT_EQ(seconds_of(session, "histograms"), 0);
    EXPECT_GT(seconds_of(session, "histogram table"), 0);
    // Nor do settings that only concern the picture prepare again ...
    scene.illumination.histogram.model = HistogramModel::paper;
    scene.illumination.histogram.effects = {true, true, true, true};
    scene.illumination.histogram.anisotropy = 0.5;
    scene.illumination.spao.levels = 3;
    image(session, scene);
    EXPECT_EQ(seconds_of(session, "prepare"), 0);
    EXPECT_GT(seconds_of(session, "illuminate"), 0);
    scene.illumination.histogram.radius = 5;  // ... but this does.
    image(session, scene);
    EXPECT_GT(seconds_of(session, "prepare"), 0);
}

TEST(HistogramLight, IsTheSameForAnyNumberOfThreadsAndInstructionSet) {
    Scene scene = scene_of();
    scene.illumination.histogram.effects.scattering = true;
    const auto one = image(soft_shells(), scene, Device::cpu(1, Isa::scalar));
    for (const Isa isa : available_isas()) EXPECT_EQ(image(soft_shells(), scene, Device::cpu(3, isa)), one);
    scene.illumination.histogram.model = HistogramModel::paper;
    EXPECT_EQ(image(soft_shells(), scene, Device::cpu(1, Isa::scalar)), image(soft_shells(), scene));
}

TEST(HistogramLight, WithoutStrengthOrEffectsIsNone) {
    Scene scene = scene_of();
    scene.lighting.strength = 0;
    const auto lit = image(soft_shells(), scene);
    scene.lighting.strength = 1;
    scene.illumination.histogram.effects = {false, false, false, false};
    const auto without_effects = image(soft_shells(), scene);
    scene.illumination.method = Method::none;
    const auto none = image(soft_shells(), scene);
    for (std::size_t i = 0; i < none.size(); ++i) {
        ASSERT_NEAR(lit[i], none[i], 1e-5);
        ASSERT_NEAR(without_effects[i], none[i], 1e-5);
    }
}

TEST(HistogramLight, EffectsChangeTheImageAloneAndTogether) {
    Session session = session_with(soft_shells());
    std::vector<std::vector<float>> seen;
    for (const HistogramEffects effects : {HistogramEffects{true, false, false, false},
                                           {false, true, false, false},
                                           {true, true, false, false},
                                           {true, true, true, false}}) {
        Scene scene = scene_of();
        scene.illumination.histogram.effects = effects;
        scene.illumination.histogram.anisotropy = 0.7;
        seen.push_back(image(session, scene));
        for (std::size_t other = 0; other + 1 < seen.size(); ++other) EXPECT_NE(seen.back(), seen[other]);
    }
}

TEST(HistogramLight, EmitsWhereNothingElseIs) {
    Session session = session_with(soft_shells());
    Scene scene = scene_of();
    scene.transfer.points->points.erase(scene.transfer.points->points.begin(),
                                        scene.transfer.points->points.begin() + 3);
    const auto opacity_in = [&](bool emits, bool skips) {
        scene.illumination.histogram.effects.emission = emits;
        scene.illumination.histogram.emission = "180:220=4";
        scene.sampling.skip_empty = skips;
        scene.sampling.early_termination = 0;
        return image(session, scene);
    };
    const auto dark = opacity_in(false, true), emissive = opacity_in(true, true);
    EXPECT_EQ(seconds_of(session, "prepare"), 0);
    int lit = 0;
    for (std::size_t i = 3; i < dark.size(); i += 4) {
        ASSERT_GE(emissive[i], dark[i] - 1e-5);
        lit += dark[i] == 0 && emissive[i] > 0.01;
    }
    EXPECT_GT(lit, 50);                            // pixels that see nothing but glow
    EXPECT_EQ(emissive, opacity_in(true, false));  // occupancy grew as far as the glow reaches
    scene.illumination.histogram.emission = "nonsense";
    scene.sampling.skip_empty = true;
    EXPECT_THROW(image(session, scene), Error);
}

TEST(HistogramLight, ShowsInEveryModeAndModel) {
    Session session = session_with(soft_shells());
    for (const Mode mode : {Mode::dvr, Mode::iso})
        for (const HistogramModel model : {HistogramModel::corrected, HistogramModel::paper}) {
            Scene scene = scene_of();
            scene.mode = mode, scene.iso = {{120}};
            scene.lighting.ambient = 0.8;
            scene.illumination.histogram.model = model;
            const auto lit = image(session, scene);
            for (float v : lit) ASSERT_TRUE(v >= 0 && v <= 1.5f);
            scene.illumination.method = Method::none;
            const auto none = image(session, scene);
            EXPECT_NE(lit, none);
            for (std::size_t i = 3; i < lit.size(); i += 4) ASSERT_EQ(lit[i], none[i]);  // opacity is no light
        }
}

/// Brightness of an open flat surface, seen head-on, against no method.
double brightness_of_halfspace(Mode mode, HistogramModel model, HistogramPath path) {
    Scene scene = scene_of({.radius = 10, .clusters = 256, .path = path, .model = model, .cache = "none"});
    scene.transfer.points.reset();
    scene.transfer.points = sample_transfer_function("halfspace");
    scene.mode = mode, scene.iso = {{100}};
    scene.camera.elevation_deg = 90;
    scene.camera.zoom = 6;
    Session session = session_with(make_sample("halfspace", 48));
    const double lit = mean(image(session, scene), 0);
    scene.illumination.method = Method::none;
    return lit / mean(image(session, scene), 0);
}

TEST(HistogramLight, KeepsTheBrightnessOfAnOpenFlatSurface) {
    for (const HistogramPath path : {HistogramPath::fast, HistogramPath::exact})
        for (const Mode mode : {Mode::dvr, Mode::iso})
            EXPECT_NEAR(brightness_of_halfspace(mode, HistogramModel::corrected, path), 1, 0.02)
                << int(path) << int(mode);
}

/// A folder of its own that goes with it.
struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("chiaro-cache-" + std::to_string(getpid()));
    Folder() { std::filesystem::remove_all(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::vector<std::filesystem::path> files() const {
        std::vector<std::filesystem::path> list;
        if (std::filesystem::exists(path))
            for (const auto& entry : std::filesystem::directory_iterator(path)) list.push_back(entry.path());
        return list;
    }
};

TEST(HistogramCache, GivesTheSameImage) {
    const Folder folder;
    Scene scene = scene_of();
    const auto without = image(soft_shells(), scene);
    scene.illumination.histogram.cache = folder.path;
    const auto computed = image(soft_shells(), scene);
    ASSERT_EQ(folder.files().size(), 1u);
    Session session = session_with(soft_shells());
    const auto kept = image(session, scene);
    EXPECT_EQ(seconds_of(session, "histogram training"), -1);  // not found again
    EXPECT_TRUE(session.notes().empty());
    EXPECT_EQ(kept, computed);
    EXPECT_EQ(kept, without);
}

TEST(HistogramCache, HasAFileForEachVolumeAndSetting) {
    const Folder folder;
    Scene scene = scene_of();
    scene.illumination.histogram.cache = folder.path;
    image(soft_shells(), scene);
    scene.illumination.histogram.model = HistogramModel::paper;  // of the picture alone
    image(soft_shells(), scene);
    EXPECT_EQ(folder.files().size(), 1u);
    scene.illumination.histogram.packed_bins = 32;
    image(soft_shells(), scene);
    EXPECT_EQ(folder.files().size(), 2u);
    Volume other = soft_shells();
    other.as<std::uint8_t>()[777] ^= 1;
    image(std::move(other), scene);
    EXPECT_EQ(folder.files().size(), 3u);
}

TEST(HistogramCache, ThatIsDamagedIsFoundAgainWithANote) {
    const Folder folder;
    Scene scene = scene_of();
    scene.illumination.histogram.cache = folder.path;
    const auto computed = image(soft_shells(), scene);
    const auto file = folder.files().at(0);
    const auto size = std::filesystem::file_size(file);
    const std::function<void()> damages[] = {
        [&] {
            std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
            bytes.seekp(std::streamoff(size / 2));
            bytes.put('\x55'), bytes.put('\xaa');
        },
        [&] { std::filesystem::resize_file(file, size / 3); }, [&] { std::filesystem::resize_file(file, 0); }};
    for (const auto& damage : damages) {
        damage();
        Session session = session_with(soft_shells());
        EXPECT_EQ(image(session, scene), computed);
        ASSERT_EQ(session.notes().size(), 1u);
        EXPECT_NE(session.notes()[0].find("is damaged"), std::string::npos);
        EXPECT_EQ(std::filesystem::file_size(file), size);  // whole again
    }
}

TEST(HistogramCache, ThatCannotBeWrittenIsOnlyANote) {
    const Folder folder;
    std::ofstream(folder.path) << "a file where the folder should be";
    Scene scene = scene_of();
    scene.illumination.histogram.cache = folder.path;
    Session session = session_with(soft_shells());
    image(session, scene);
    ASSERT_EQ(session.notes().size(), 1u);
    EXPECT_NE(session.notes()[0].find("not kept"), std::string::npos);
}

TEST(HistogramLight, CanBeCancelledWhileItIsPrepared) {
    Session session = session_with(soft_shells(64));
    Progress progress([&](std::string_view stage, double) {
        if (stage == "histogram training") progress.cancel();
    });
    try {
        session.render(scene_of(), progress);
        FAIL() << "was not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted);
    }
    image(session, scene_of());  // and made after all
    EXPECT_GT(seconds_of(session, "histograms"), 0);
}

/// Mean colour of a part of a Cornell box's picture, seen from its open side; in fractions of the picture.
struct Hue {
    double red = 0, green = 0, blue = 0;
    double red_over_green() const { return red / green; }
};
Hue colour_of(const std::vector<float>& rgba, int width, int height, double x0, double x1, double y0, double y1) {
    Hue hue;
    for (int y = int(y0 * height); y < int(y1 * height); ++y)
        for (int x = int(x0 * width); x < int(x1 * width); ++x) {
            const float* p = &rgba[std::size_t(4 * (y * width + x))];
            hue.red += p[0], hue.green += p[1], hue.blue += p[2];
        }
    return hue;
}

TEST(HistogramLight, BleedsTheColoursOfTheCornellBox) {
    constexpr int size = 128;
    Scene scene = scene_of({.radius = 16, .clusters = 1024, .cache = "none"});
    scene.transfer.points = sample_transfer_function("cornell");
    scene.sampling.classification = Classification::pre;
    scene.camera.azimuth_deg = 270;  // into the open side, -y; red on the left
    scene.camera.elevation_deg = 0;
    scene.camera.zoom = 1.5;
    scene.width = scene.height = size;
    Session session = session_with(make_sample("cornell", 64));
    const auto left_and_right = [&] {
        const auto rgba = image(session, scene);
        // The back wall beside either coloured wall.
        return std::pair(colour_of(rgba, size, size, 0.20, 0.26, 0.35, 0.65),
                         colour_of(rgba, size, size, 0.74, 0.80, 0.35, 0.65));
    };
    const auto [red_side, green_side] = left_and_right();
    EXPECT_GT(red_side.red_over_green(), 1.1 * green_side.red_over_green());
    // It is bleeding that does it, not the walls themselves.
    scene.illumination.histogram.effects.bleeding = false;
    const auto [left, right] = left_and_right();
    EXPECT_NEAR(left.red_over_green(), right.red_over_green(), 0.01);
    EXPECT_GT(red_side.red_over_green(), 1.05 * left.red_over_green());
    EXPECT_LT(green_side.red_over_green(), right.red_over_green());
    scene.illumination.histogram.effects.bleeding = true;
    // The red wall made transparent by the transfer function alone: nothing is prepared again, and its colour goes.
    for (ControlPoint& p : scene.transfer.points->points)
        if (p.value >= 65 && p.value <= 95) p.opacity = 0;
    const auto [clear_side, other_side] = left_and_right();
    EXPECT_EQ(seconds_of(session, "prepare"), 0);
    EXPECT_LT(clear_side.red_over_green(), 1.03 * 0.87 / 0.86 * 0.87 / 0.86);
    EXPECT_NEAR(other_side.red_over_green(), green_side.red_over_green(), 0.02);
}

ComputedField field_of(const Volume& volume, const TransferFunction& tf, const HistogramSettings& histogram) {
    const IlluminationSettings settings{.method = Method::histogram, .histogram = histogram};
    Progress progress;
    const Device device = tested_device();
    const DeviceVolume voxels = upload(device, volume);
    return compute_field(device, classify(voxels, tf, {}), prepare(voxels, settings, progress), {}, settings, progress);
}

TEST(HistogramField, IsOcclusionOrColour) {
    const HistogramSettings settings{.radius = 6, .clusters = 64, .effects = {.bleeding = false}, .cache = "none"};
    const Volume volume = soft_shells(32);
    const auto opaque = field_of(volume, chiaro::testing::constant(1), settings),
               clear = field_of(volume, chiaro::testing::constant(0), settings);
    ASSERT_EQ(opaque.volume.components, 1);
    EXPECT_EQ(opaque.volume.key_values.at("chiaro_field"), "environment occlusion");
    EXPECT_NEAR(opaque.volume.as<float>()[(16 * 32 + 16) * 32 + 16], 1, 0.02);
    EXPECT_LT(opaque.volume.as<float>()[0], 0.4);  // most of a corner's ball lies outside
    for (float o : clear.volume.as<float>()) ASSERT_EQ(o, 0);
    HistogramSettings colour = settings;
    colour.effects.bleeding = true;
    const auto field = field_of(volume, chiaro::testing::constant(1, {0.25, 0.5, 1}), colour);
    ASSERT_EQ(field.volume.components, 3);
    const float* e = &field.volume.as<float>()[3 * ((16 * 32 + 16) * 32 + 16)];
    EXPECT_NEAR(e[0], 0.25, 0.01);
    EXPECT_NEAR(e[2], 1, 0.02);
}

TEST(HistogramRadius, IsProposedFromTheData) {
    const auto boxes = [](int distance) {
        const Volume volume =
            chiaro::testing::sampled<std::uint8_t>({96, 96, 96}, [distance](double x, double y, double z) {
                return (int(x) / distance + int(y) / distance + int(z) / distance) % 2 ? 250 : 60;
            });
        return proposed_radius(upload(tested_device(), volume));
    };
    EXPECT_LT(boxes(8), boxes(24));
    EXPECT_GE(boxes(8), 4);
    EXPECT_LE(boxes(60), 32);
}

}  // namespace
