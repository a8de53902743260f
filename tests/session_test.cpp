// A session redoes what lies right of a change, and nothing else.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>

#include <cmath>

#include "devices.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

struct SessionTest : ::testing::Test {
    Progress progress;
    Session session{tested_device()};
    Scene scene;

    void SetUp() override {
        scene.volume = "sample:ball:24";
        scene.width = 40, scene.height = 30;
        scene.camera.fit = Fit::volume;
        scene.illumination.method = Method::none;
        scene.interpolation = Interpolation::linear;
        session.show(make_sample("ball", 24), progress);
        session.render(scene, progress);
    }

    /// Names of the stages that the next render really does.
    std::string redone() {
        session.render(scene, progress);
        std::string names;
        for (const auto& stage : session.stages())
            if (stage.seconds > 0) names += (names.empty() ? "" : " ") + stage.name;
        return names;
    }
};

}  // namespace

TEST_F(SessionTest, TellsEveryStageInOrder) {
    const auto names = [&] {
        std::string all;
        for (const auto& stage : session.stages()) all += stage.name + " ";
        return all;
    };
    EXPECT_EQ(names(), "measure upload prepare classify illuminate raycast develop ");
    EXPECT_GT(session.stages()[1].seconds, 0);
    EXPECT_GT(session.render_statistics().samples, 0u);
    scene.camera.fit = Fit::visible;
    EXPECT_EQ(redone(), "fit raycast develop");
    EXPECT_EQ(names(), "measure upload prepare classify fit illuminate raycast develop ");
    scene.camera.zoom = 2;
    EXPECT_EQ(redone(), "raycast develop") << "which multiplies what was found";
}

TEST_F(SessionTest, LightFollowsAnEditAndItsStepsAreTold) {
    scene.illumination.method = Method::spao;
    scene.illumination.spao.levels = 3;
    EXPECT_EQ(redone(), "illuminate opacity spao mipmaps spao cells of 2 spao cells of 1 raycast develop");
    EXPECT_EQ(redone(), "");
    scene.transfer.source = "gray";
    EXPECT_EQ(redone(), "classify illuminate opacity spao mipmaps spao cells of 2 spao cells of 1 raycast develop");
    scene.camera.azimuth_deg += 10;
    EXPECT_EQ(redone(), "raycast develop");
    scene.lighting.strength = 0.5;
    EXPECT_EQ(redone(), "raycast develop");
}

TEST_F(SessionTest, ColoursAloneLeaveTheLightOfOpacities) {
    scene.transfer.points = TransferFunction{{{0.2, {1, 1, 1}, 0}, {0.8, {1, 0.5, 0.2}, 0.4}}};
    for (const Method method : {Method::spao, Method::visibility}) {
        scene.illumination.method = method;
        for (const Interpolation interpolation : {Interpolation::linear, Interpolation::automatic}) {
            scene.interpolation = interpolation;
            session.render(scene, progress);
            scene.transfer.points->points[1].rgb[2] += 0.1, scene.transfer.points->points[0].name = "Skin";
            EXPECT_FALSE(session.needs_light(scene));
            EXPECT_EQ(redone().find("illuminate"), std::string::npos) << redone();
            EXPECT_EQ(session.render(scene, progress).pixels, render_image(tested_device(), scene, progress).pixels);
            scene.transfer.points->points[1].opacity += 0.05;
            EXPECT_TRUE(session.needs_light(scene));
            EXPECT_NE(redone().find("illuminate"), std::string::npos);
            EXPECT_EQ(session.render(scene, progress).pixels, render_image(tested_device(), scene, progress).pixels);
        }
    }
    scene.illumination.method = Method::transport, scene.illumination.transport.grid = 8;
    session.render(scene, progress);
    scene.transfer.points->points[1].rgb[0] = 0.1;
    EXPECT_TRUE(session.needs_light(scene)) << "what is scattered has another colour";
}

TEST_F(SessionTest, KeepsEverythingWithoutAChange) { EXPECT_EQ(redone(), ""); }

TEST_F(SessionTest, CameraMovesStartAtRaycast) {
    scene.camera.azimuth_deg += 10;
    EXPECT_EQ(redone(), "raycast develop");
    scene.lighting.ambient = 0.5;
    EXPECT_EQ(redone(), "raycast develop");
    scene.sampling.step_voxels = 1;
    EXPECT_EQ(redone(), "raycast develop");
    scene.width = 50;
    EXPECT_EQ(redone(), "raycast develop");
    EXPECT_EQ(session.frame().width, 50);
}

TEST_F(SessionTest, BackgroundsStartAtDevelop) {
    scene.output.background = {1, 1, 1};
    EXPECT_EQ(redone(), "develop");
    scene.output.transparent = true;
    EXPECT_EQ(redone(), "develop");
}

TEST_F(SessionTest, TransferFunctionsStartAtClassify) {
    for (const auto& change : std::vector<std::function<void()>>{[&] { scene.transfer.source = "gray"; },
                                                                 [&] { scene.transfer.opacity_scale = 0.5; },
                                                                 [&] {
                                                                     scene.transfer.threshold = {10, 300};
                                                                 },
                                                                 [&] { scene.output.color = ColorMode::display; }}) {
        change();
        EXPECT_EQ(redone(), "classify illuminate raycast develop");
    }
}

TEST_F(SessionTest, NewVolumesStartOver) {
    const auto before = session.render(scene, progress).pixels;
    session.show(make_sample("menger", 24), progress);
    EXPECT_EQ(redone(), "measure upload prepare classify illuminate raycast develop");
    EXPECT_NE(session.render(scene, progress).pixels, before);
}

TEST_F(SessionTest, GivesTheImageOfRenderImage) {
    EXPECT_EQ(session.render(scene, progress).pixels, render_image(Device::cpu(1), scene, progress).pixels);
}

TEST_F(SessionTest, ShowsCoarseLightWhileFinerLightIsFound) {
    scene.illumination.method = Method::visibility;
    scene.illumination.visibility.directions = 100;
    const auto at_once = session.render(scene, progress).pixels;
    std::vector<Image> previews;
    const auto keep = [&](const Image& image) { previews.push_back(image); };
    session.render(scene, progress, keep);
    EXPECT_TRUE(previews.empty()) << "nothing has changed";

    scene.illumination.visibility.directions = 99;
    session.render(scene, progress);
    scene.illumination.visibility.directions = 100;
    EXPECT_EQ(session.render(scene, progress, keep).pixels, at_once);
    ASSERT_EQ(previews.size(), 2u);  // a node for 8 cells per axis, then for 4; the finest for 2
    double worst = 1e30;
    for (const Image& preview : previews) {
        ASSERT_EQ(preview.pixels.size(), at_once.size());
        double squares = 0;
        for (std::size_t i = 0; i < at_once.size(); ++i) squares += std::pow(preview.pixels[i] - at_once[i], 2);
        EXPECT_GT(squares, 0);
        EXPECT_LT(squares, worst) << "each is nearer than the one before";
        worst = squares;
    }
}

TEST_F(SessionTest, ACancelledPreviewLeavesNothingHalfDone) {
    scene.illumination.method = Method::visibility;
    scene.illumination.visibility.directions = 100;
    Progress cancelled;
    int previews = 0;
    const auto stop = [&](const Image&) { ++previews, cancelled.cancel(); };
    EXPECT_THROW(session.render(scene, cancelled, stop), Error);
    EXPECT_EQ(previews, 1);
    EXPECT_EQ(session.render(scene, progress).pixels, render_image(Device::cpu(1), scene, progress).pixels);
}

namespace {

/// Of a picture's values, root of the mean square.
double distance_of(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += std::pow(double(a[i]) - b[i], 2);
    return std::sqrt(squares / double(a.size()));
}

struct TransportSession : SessionTest {
    std::vector<Image> previews;
    const Preview keep = [&](const Image& image) { previews.push_back(image); };

    void SetUp() override {
        SessionTest::SetUp();
        scene.illumination.method = Method::transport;
        scene.illumination.transport = {.grid = 24, .directions = 24, .first_directions = 100, .error = 0.002};
        scene.lighting.probe.source = "sky";
        scene.transfer.opacity_scale = 0.3;
        session.render(scene, progress, keep);
    }
    bool redid(const std::string& verb) { return (" " + redone() + " ").find(" " + verb + " ") != std::string::npos; }
};

}  // namespace

TEST_F(TransportSession, ShowsAPictureForEachIteration) {
    ASSERT_GE(previews.size(), 4u);
    const auto last = session.render(scene, progress).pixels;
    EXPECT_GT(distance_of(previews.front().pixels, last), 0);
    EXPECT_LT(distance_of(previews.front().pixels, last), 8) << "something to see at once";
    EXPECT_LT(distance_of(previews.back().pixels, last), 0.5) << "no flicker at the end";
    EXPECT_LT(distance_of(previews.back().pixels, last), distance_of(previews.front().pixels, last));
    previews.clear();
    session.render(scene, progress, keep);
    EXPECT_TRUE(previews.empty()) << "nothing has changed";
}

TEST_F(TransportSession, FindsLightAgainWhereTheProbeTurnsOrChanges) {
    EXPECT_EQ(redone(), "");
    scene.lighting.probe.rotation_deg = 90;
    EXPECT_TRUE(redid("illuminate"));
    EXPECT_FALSE(redid("illuminate"));
    scene.lighting.probe.source = "studio";
    EXPECT_TRUE(redid("illuminate"));
    scene.camera.up = Vec3{0, 1, 0};  // the probe stands by it
    EXPECT_TRUE(redid("illuminate"));
    scene.transfer.opacity_scale = 0.2;
    EXPECT_TRUE(redid("illuminate"));
}

TEST_F(TransportSession, ExposureStrengthAndCameraFindNoLight) {
    scene.lighting.probe.exposure = 1;
    EXPECT_EQ(redone(), "raycast develop");
    scene.lighting.strength = 0.5;
    EXPECT_EQ(redone(), "raycast develop");
    scene.lighting.shading = Shading::none;
    EXPECT_EQ(redone(), "raycast develop");
    scene.camera.azimuth_deg += 20;
    EXPECT_EQ(redone(), "raycast develop");
}

TEST_F(TransportSession, OtherMethodsFindNoLightForAProbe) {
    scene.illumination.method = Method::visibility;
    session.render(scene, progress);
    scene.lighting.probe.rotation_deg = 90;
    EXPECT_EQ(redone(), "raycast develop");
    scene.camera.up = Vec3{0, 1, 0};
    EXPECT_EQ(redone(), "raycast develop");
}

/// What an iteration still changes, by 8 bits: warm light starts elsewhere and ends there too.
TEST_F(TransportSession, WarmAndColdLightAgree) {
    const auto cold = [&] {
        Session fresh(tested_device());
        fresh.show(make_sample("ball", 24), progress);
        return fresh.render(scene, progress).pixels;
    };
    scene.transfer.opacity_scale = 0.6;
    EXPECT_LT(distance_of(session.render(scene, progress).pixels, cold()), 1);
    scene.lighting.probe.rotation_deg = 120;
    EXPECT_LT(distance_of(session.render(scene, progress).pixels, cold()), 1);
    scene.illumination.transport.grid = 16;
    EXPECT_LT(distance_of(session.render(scene, progress).pixels, cold()), 1);
}

TEST_F(TransportSession, ACancelledIterationLeavesNothingHalfDone) {
    scene.transfer.opacity_scale = 0.6;
    Progress cancelled;
    int seen = 0;
    const auto stop = [&](const Image&) {
        if (++seen == 2) cancelled.cancel();
    };
    EXPECT_THROW(session.render(scene, cancelled, stop), Error);
    EXPECT_EQ(seen, 2);
    EXPECT_LT(distance_of(session.render(scene, progress).pixels, render_image(Device::cpu(1), scene, progress).pixels),
              1);
}

TEST_F(SessionTest, AnInterruptedRenderIsDoneAgain) {
    const auto before = session.render(scene, progress).pixels;
    scene.camera.azimuth_deg += 90;
    Progress cancelled;
    cancelled.cancel();
    EXPECT_THROW(session.render(scene, cancelled), Error);
    scene.camera.azimuth_deg -= 90;
    EXPECT_EQ(session.render(scene, progress).pixels, before);
}

TEST_F(SessionTest, GivesTheTransferFunctionItUsed) {
    scene.transfer.points.emplace().points = {{0, {0, 0, 0}, 0}, {10, {1, 1, 1}, 0.5}};
    scene.transfer.window = {100, 50};
    scene.transfer.opacity_unit_mm = 4;
    session.render(scene, progress);
    EXPECT_DOUBLE_EQ(session.transfer_function().points.front().value, 75);
    EXPECT_DOUBLE_EQ(session.transfer_function().points.back().value, 125);
    EXPECT_EQ(session.transfer_function().opacity_unit, 4);
    EXPECT_TRUE(session.transfer_function().opacity_unit_is_mm);
}

TEST(Session, NeedsAVolume) {
    Progress progress;
    Session session(Device::cpu(1));
    EXPECT_THROW(session.render(Scene(), progress), Error);
}

TEST_F(SessionTest, DraftsByTheLightAtHand) {
    scene.illumination.method = Method::spao;
    EXPECT_TRUE(session.needs_light(scene));
    const Image lit = session.render(scene, progress);
    EXPECT_FALSE(session.needs_light(scene));
    EXPECT_TRUE(session.preview(scene, progress).pixels == lit.pixels) << "the last computed lighting is the right one";

    scene.camera.azimuth_deg += 30;
    EXPECT_FALSE(session.needs_light(scene));
    scene.transfer.opacity_scale = 0.2;
    EXPECT_TRUE(session.needs_light(scene));
    const Image preview = session.preview(scene, progress);
    EXPECT_TRUE(session.needs_light(scene)) << "a draft finds none";
    for (const auto& stage : session.stages()) EXPECT_NE(stage.name, "illuminate");
    const Image right = session.render(scene, progress);
    EXPECT_FALSE(preview.pixels == right.pixels);

    Scene small = scene;
    small.width = 20, small.height = 15;
    EXPECT_EQ(session.preview(small, progress).width, 20);
    EXPECT_EQ(redone(), "") << "what render keeps stays kept";
}

TEST_F(SessionTest, DraftsAreLinearWhereFinalPicturesAreFiner) {
    scene.camera.fit = Fit::visible;
    const auto drawn = [&](Interpolation interpolation, bool is_draft) {
        scene.interpolation = interpolation;
        return is_draft ? session.preview(scene, progress).pixels : session.render(scene, progress).pixels;
    };
    const auto draft = drawn(Interpolation::automatic, true);
    const CameraSettings camera = session.camera();
    const auto fine = drawn(Interpolation::automatic, false);
    EXPECT_EQ(session.camera(), camera) << "drafts fit what final pictures show";
    EXPECT_EQ(render_image(tested_device(), scene, progress).pixels, fine);
    scene.camera = camera;
    const auto linear = drawn(Interpolation::linear, false);
    EXPECT_EQ(draft, linear);
    EXPECT_NE(fine, linear);
    EXPECT_EQ(drawn(Interpolation::automatic, true), linear);
    // A few voxels of a ball, which is thick: smooth.
    EXPECT_GT(session.statistics().noise, worth_smoothing);
    EXPECT_EQ(drawn(Interpolation::smooth, false), fine);
    EXPECT_EQ(drawn(Interpolation::smooth, true), fine) << "who names one gets it at once";
    EXPECT_NE(drawn(Interpolation::cubic, false), fine);
    EXPECT_EQ(session.camera(), camera);
    scene.sampling.classification = Classification::pre;  // of materials
    EXPECT_EQ(drawn(Interpolation::automatic, false), drawn(Interpolation::linear, false));
}

// A preview that is lit finds the light of the final picture, which then need not be found again.
TEST_F(SessionTest, LitDraftsHaveTheFinalPicturesLight) {
    scene.illumination.method = Method::spao;
    scene.interpolation = Interpolation::automatic;
    EXPECT_TRUE(session.needs_light(scene));
    session.preview(scene, progress, DraftLight::own);
    EXPECT_FALSE(session.needs_light(scene));
    EXPECT_EQ(redone(), "raycast develop");
}

TEST_F(SessionTest, SessionsBesideShareTheVoxelsAlone) {
    Session other = session.share_volume();
    EXPECT_EQ(&other.volume().data(), &session.volume().data());
    scene.transfer.source = "gray";
    const Image theirs = other.render(scene, progress);
    EXPECT_TRUE(session.render(scene, progress).pixels == theirs.pixels);
    EXPECT_EQ(other.guess().preset, session.guess().preset);
}

// What a session of one look gives back is in none of its pictures.
TEST(OneLook, PicturesAreTheSameAndOthersAreRefused) {
    Progress progress;
    Scene scene;
    scene.volume = "sample:shells:96";
    scene.width = 64, scene.height = 48;
    scene.transfer.threshold = {{100, 1000}};
    for (const Method method : {Method::none, Method::spao, Method::visibility})
        for (const Classification classification :
             {Classification::post, Classification::pre, Classification::preintegrated}) {
            scene.illumination.method = method;
            scene.sampling.classification = classification;
            Session whole(tested_device()), one(tested_device());
            whole.show(make_sample("shells", 96), progress);
            one.show(make_sample("shells", 96), progress);
            one.expect_one_look();
            for (const double azimuth : {0.0, 50.0}) {
                scene.camera.azimuth_deg = azimuth;
                const Image expected = whole.render(scene, progress);
                EXPECT_EQ(one.render(scene, progress).pixels, expected.pixels) << int(method) << int(classification);
            }
            if (method == Method::visibility || classification == Classification::preintegrated) continue;
            Scene other = scene;
            other.transfer.threshold = {{50, 1000}};
            EXPECT_THROW(one.render(other, progress), Error);
            other = scene;
            other.illumination.method = Method::visibility;
            EXPECT_THROW(one.render(other, progress), Error);
            EXPECT_THROW(one.compute_field(scene, progress), Error);
        }
}
