// What the camera fits: what is visible fills nine tenths of the picture, found once.
#include <chiaro/error.h>

#include "fixtures.h"
#include "volume_files.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

/// Of the rays of an opacity above .1: how much of the width or height they fill, and whether any meets the border.
struct Filled {
    double share = 0;
    bool cut = false;
};

Filled filled(const Frame& frame) {
    int left = frame.width, right = -1, top = frame.height, bottom = -1;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            if (frame.rgba[4 * (std::size_t(y) * frame.width + x) + 3] <= 0.1f) continue;
            left = std::min(left, x), right = std::max(right, x);
            top = std::min(top, y), bottom = std::max(bottom, y);
        }
    if (right < 0) return {};
    return {std::max(double(right - left + 1) / frame.width, double(bottom - top + 1) / frame.height),
            left == 0 || top == 0 || right == frame.width - 1 || bottom == frame.height - 1};
}

/// A volume as a session shows it, without light: it does not change what is covered.
struct Shown {
    Session session{tested_device()};
    Scene scene;
    Progress progress;

    explicit Shown(const std::string& volume, int width = 240, int height = 180) {
        scene = scene_of_volume(volume);
        scene.illumination.method = Method::none;
        scene.interpolation = Interpolation::linear;  // which is fitted
        scene.width = width, scene.height = height;
        session.show(read_volume(scene, progress), progress);
    }
    Filled operator()() {
        session.render(scene, progress);
        return filled(session.frame());
    }
};

void expect_fits(const Filled& seen, const std::string& what) {
    EXPECT_GE(seen.share, 0.85) << what;
    EXPECT_LE(seen.share, 0.95) << what;
    EXPECT_FALSE(seen.cut) << what;
}

}  // namespace

TEST(Fit, EverySampleFillsItsPicture) {
    for (const SampleInfo& sample : list_samples()) expect_fits(Shown("sample:" + sample.name + ":64")(), sample.name);
}

TEST(Fit, AnyViewProjectionAndShapeOfPicture) {
    Shown shown("sample:tubes:64");
    for (const auto& [width, height] : {std::pair(240, 100), std::pair(90, 200), std::pair(150, 150)})
        for (const Projection projection : {Projection::perspective, Projection::orthographic})
            for (const double elevation : {-90.0, 10.0, 60.0})
                for (const double fov : {10.0, 90.0}) {
                    shown.scene.width = width, shown.scene.height = height;
                    shown.scene.camera = {.azimuth_deg = 70,
                                          .elevation_deg = elevation,
                                          .roll_deg = 30,
                                          .fov_deg = fov,
                                          .projection = projection};
                    expect_fits(shown(), fmt::format("{}x{}, {}, {} up, {}", width, height, to_text(projection),
                                                     elevation, fov));
                }
}

/// The ball found around a ball is that ball, to a pixel of the small pictures.
TEST(Fit, FindsABallWhereItIs) {
    const int n = 64;
    const Vec3 centre{40, 22, 30};
    const double radius = 14;
    const Volume volume = chiaro::testing::sampled<float>({n, n, n}, [&](double x, double y, double z) {
        return 255 * std::clamp(radius + 0.5 - length(Vec3{x, y, z} - centre), 0.0, 1.0);
    });
    TransferFunction tf;  // a surface at half the value
    tf.points = {{127, {1, 1, 1}, 0}, {128, {1, 1, 1}, 1}};
    Progress progress;
    const Medium medium = classify(upload(tested_device(), volume), tf, {});
    const CameraSettings flat{.projection = Projection::orthographic};
    const CameraSettings found = fit_camera(tested_device(), medium, flat, {}, 200, 200, progress);
    EXPECT_LT(length(*found.fit_centre - centre), 0.03 * radius);
    EXPECT_NEAR(*found.fit_radius_mm, radius / 0.91, 0.03 * radius);
    // Seen from another side it is the same ball.
    const CameraSettings turned =
        fit_camera(tested_device(), medium, {.azimuth_deg = 170, .projection = Projection::orthographic}, {}, 200, 200,
                   progress, true);
    EXPECT_LT(length(*turned.fit_centre - centre), 0.03 * radius);
    EXPECT_NEAR(*turned.fit_radius_mm, radius / 0.91, 0.03 * radius);
}

TEST(Fit, IsKeptByEditsClipsAndOrbits) {
    Shown shown("sample:shells:48");
    shown();
    const CameraSettings found = shown.session.camera();
    ASSERT_TRUE(found.fit_centre);
    shown.scene.camera = found;
    shown.scene.clip.box = std::array{0.0, 1.0, 0.0, 1.0, 0.0, 0.3};
    shown.scene.camera.azimuth_deg += 77;
    shown.scene.transfer.source = "gray";
    shown();
    EXPECT_EQ(shown.session.camera().fit_centre, found.fit_centre);
    EXPECT_EQ(shown.session.camera().fit_radius_mm, found.fit_radius_mm);
    for (const Stage& stage : shown.session.stages()) EXPECT_NE(stage.name, "fit");
    // Asked for again it is another.
    shown.scene.camera.fit_centre.reset(), shown.scene.camera.fit_radius_mm.reset();
    expect_fits(shown(), "cut to a third");
    EXPECT_NE(shown.session.camera().fit_radius_mm, found.fit_radius_mm);
}

TEST(Fit, ZoomMultipliesIt) {
    Shown shown("sample:ball:48");
    shown.scene.camera.projection = Projection::orthographic;
    shown.scene.camera.zoom = 0.5;
    EXPECT_NEAR(shown().share, 0.455, 0.025);
}

TEST(Fit, NoFrameOfATurntableIsCut) {
    for (const char* name : {"sample:tubes:64", "sample:menger:27"}) {
        Shown shown(name, 160, 120);
        shown.scene.camera = shown.session.fit_all_around(shown.scene, shown.progress);
        double most = 0;
        for (int frame = 0; frame < 24; ++frame) {
            Scene turned = shown.scene;
            turned.camera.azimuth_deg += 15 * frame;
            shown.session.render(turned, shown.progress);
            const Filled seen = filled(shown.session.frame());
            EXPECT_FALSE(seen.cut) << name << " frame " << frame;
            most = std::max(most, seen.share);
        }
        EXPECT_LE(most, 0.97) << name;
        EXPECT_GE(most, 0.8) << name;
    }
}

TEST(Fit, NothingVisibleFitsTheVolume) {
    Shown shown("sample:ball:32");
    shown.scene.transfer.threshold = {1e6, 2e6};
    EXPECT_EQ(shown().share, 0);
    EXPECT_FALSE(shown.session.camera().fit_centre);
}

TEST(Fit, ScenesKeepWhatWasFound) {
    Shown shown("sample:tubes:48");
    shown();
    shown.scene.camera = shown.session.camera();
    std::vector<std::string> unknown;
    const Scene again = parse_scene(to_json(shown.scene), ".", {}, unknown);
    EXPECT_TRUE(unknown.empty());
    EXPECT_EQ(again.camera, shown.scene.camera);

    const auto fit_of = [&](const std::string& camera) {
        return parse_scene(R"({"volume": {"file": "sample:ball"}, "camera": )" + camera + "}", ".", {}, unknown)
            .camera.fit;
    };
    EXPECT_EQ(fit_of("{}"), Fit::visible);
    EXPECT_EQ(fit_of(R"({"fit_scale": 0.6})"), Fit::volume) << "as scenes were before there was a choice";
    EXPECT_EQ(fit_of(R"({"fit_scale": 0.6, "fit": "visible"})"), Fit::visible);
    EXPECT_THROW(fit_of(R"({"fit_radius": 3})"), Error);
    EXPECT_THROW(fit_of(R"({"fit_radius": 0, "fit_centre": [0, 0, 0]})"), Error);
}

/// From between the front and the patient's left, a little above, in either frame; elsewhere as ever.
TEST(Fit, TheFirstViewIsThreeQuarters) {
    for (const World world : {World::lps, World::ras, World::unknown}) {
        Geometry geometry;
        geometry.world = world;
        CameraSettings first;
        first.by_frame = true;
        const Vec3 to_eye = -make_camera(first, geometry, {9, 9, 9}).forward;
        const Vec3 anterior{0, world == World::ras ? 1.0 : -1.0, 0}, left{world == World::ras ? -1.0 : 1.0, 0, 0};
        if (world == World::unknown) {
            EXPECT_EQ(make_camera(first, geometry, {9, 9, 9}), make_camera({}, geometry, {9, 9, 9}));
            continue;
        }
        EXPECT_GT(dot(to_eye, anterior), dot(to_eye, left));
        EXPECT_GT(dot(to_eye, left), 0.4);
        EXPECT_GT(to_eye.z, 0.2);
    }
}

// A head in a studio was lit from behind.
TEST(Fit, ProbesStandBesideTheFirstView) {
    for (const auto& [world, turned] : {std::pair{World::lps, -90.0}, {World::ras, 90.0}, {World::unknown, 0.0}}) {
        Session session(tested_device());
        Progress progress;
        Volume volume = make_sample("ball", 24);
        volume.geometry.world = world;
        session.show(std::move(volume), progress);
        Scene scene = scene_of_volume("sample:ball:24");
        scene.width = 24, scene.height = 20;
        scene.illumination.method = Method::visibility;
        scene.lighting.probe.source = "studio";
        const auto shown = session.render(scene, progress).pixels;
        stand_by_frame(scene, world);
        EXPECT_EQ(scene.lighting.probe.rotation_deg, turned);
        EXPECT_EQ(session.render(scene, progress).pixels, shown);
        // Seen from there it is lit as a ball without a frame is.
        scene.camera.azimuth_deg -= turned, scene.lighting.probe.rotation_deg = 0;
        const auto elsewhere = session.render(scene, progress).pixels;
        double difference = 0;
        for (std::size_t i = 0; i < shown.size(); ++i) difference += std::abs(int(shown[i]) - int(elsewhere[i]));
        EXPECT_LT(difference / double(shown.size()), 1.5) << turned;
        // Who says how it is turned is heard.
        Scene told = scene_of_volume("sample:ball:24");
        set_by_name(told, {{"probe-rotation", "0"}}, [](auto name, auto) { return std::string(name); });
        stand_by_frame(told, world);
        EXPECT_EQ(told.lighting.probe.rotation_deg, 0);
    }
}

TEST(Fit, EveryRealVolumeFillsItsPicture) {
    const char* data = std::getenv("CHIARO_DATA_DIR");
    if (!data) GTEST_SKIP() << "skipped: no data";
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "volumes")) {
        const std::string ending = entry.path().extension();
        if (ending == ".zip" || entry.path().filename() == "tooth.raw") continue;
        expect_fits(Shown(entry.path().string(), 320, 240)(), entry.path().filename());
    }
}
