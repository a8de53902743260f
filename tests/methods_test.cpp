// Lighting methods beside the ground truth, and the pictures that show where they differ.
#include <chiaro/comparison.h>
#include <chiaro/samples.h>
#include <chiaro/sheet.h>

#include "fixtures.h"
#include "tool_case.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

Frame flat(int width, int height, Rgb color) {
    Frame frame(width, height);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] = i % 4 == 3 ? 1 : float(color[i % 4]);
    return frame;
}

Rgb pixel(const Image& image, int x, int y) {
    const std::uint8_t* p = image.pixels.data() + 3 * (std::size_t(y) * image.width + x);
    return {double(p[0]), double(p[1]), double(p[2])};
}

/// So thin that nearly all light arrives everywhere: whatever a method leaves out does not matter.
Scene haze() {
    Scene scene;
    scene.volume = "sample:ball:24";
    scene.width = 48, scene.height = 36;
    scene.transfer.points.emplace().points = {{0, {1, 0.5, 0.2}, 0}, {100, {1, 0.5, 0.2}, 0.001}};
    scene.illumination.reference.rays = 64;
    scene.illumination.histogram.cache = "none";
    scene.illumination.surfaces = SurfaceModel::none;
    return scene;
}

MethodComparison compared(const Scene& scene, const std::vector<Method>& methods,
                          const Device& device = tested_device()) {
    Progress progress;
    Session session(device);
    session.show(read_volume(scene, progress), progress);
    return compare_methods(session, scene, methods, progress);
}

class MethodsTool : public ToolTest {};

}  // namespace

TEST(DifferenceImage, IsWhiteRedAndBlue) {
    const Frame ground_truth = flat(4, 3, {0.5, 0.5, 0.5});
    EXPECT_EQ(pixel(difference_image(ground_truth, ground_truth, 0.1), 1, 1), (Rgb{255, 255, 255}));
    const Rgb brighter = pixel(difference_image(flat(4, 3, {0.6, 0.6, 0.6}), ground_truth, 0.1), 3, 2);
    const Rgb darker = pixel(difference_image(flat(4, 3, {0.1, 0.1, 0.1}), ground_truth, 0.1), 0, 0);
    EXPECT_GT(brighter[0], brighter[2] + 100);
    EXPECT_GT(darker[2], darker[0] + 100);
    // The colour changes, the luminance does not.
    const Rgb same = pixel(difference_image(flat(4, 3, {0.5 + 0.0722, 0.5, 0.5 - 0.2126}), ground_truth, 0.1), 0, 0);
    EXPECT_EQ(same, (Rgb{255, 255, 255}));
    EXPECT_THROW(difference_image(flat(3, 4, {}), ground_truth, 0.1), Error);
}

TEST(DifferenceImage, ScaleIsARoundNumberAboveNearlyAll) {
    const Frame ground_truth = flat(100, 20, {0.5, 0.5, 0.5});
    Frame other = flat(100, 20, {0.53, 0.53, 0.53});
    for (int i = 0; i < 8; ++i) other.rgba[4 * i] = 100;  // eight of 2000
    EXPECT_DOUBLE_EQ(difference_scale(other, ground_truth), 0.05);
    EXPECT_DOUBLE_EQ(difference_scale(flat(9, 9, {0.29, 0.29, 0.29}), flat(9, 9, {0.2, 0.2, 0.2})), 0.1);
    EXPECT_GT(difference_scale(ground_truth, ground_truth), 0);
}

TEST(ContactSheet, PutsImagesInRowsWithCaptionsBelow) {
    const Image red = develop(flat(40, 30, {1, 0, 0}), {}), green = develop(flat(40, 30, {0, 1, 0}), {});
    const Image sheet = contact_sheet({{{red, "ab"}, {green, ""}}, {{{}, ""}, {red, ""}}});
    ASSERT_EQ(sheet.width, 8 + 2 * 48);
    const int row = 30 + 18 + 16;
    ASSERT_EQ(sheet.height, 8 + 2 * row);
    EXPECT_EQ(pixel(sheet, 8, 8), (Rgb{255, 0, 0}));
    EXPECT_EQ(pixel(sheet, 8 + 48, 8 + 29), (Rgb{0, 255, 0}));
    EXPECT_EQ(pixel(sheet, 8, 8 + row), pixel(sheet, 0, 0)) << "an empty place";
    EXPECT_EQ(pixel(sheet, 8 + 48 + 39, 8 + row), (Rgb{255, 0, 0}));
    int below_first = 0, below_second = 0;
    for (int y = 8 + 30; y < 8 + row; ++y)
        for (int x = 8; x < 8 + 40; ++x) {
            below_first += pixel(sheet, x, y)[0] > 200;
            below_second += pixel(sheet, x + 48, y)[0] > 200;
        }
    EXPECT_GT(below_first, 50);
    EXPECT_EQ(below_second, 0);
    EXPECT_THROW(contact_sheet({{{red, ""}, {develop(flat(30, 30, {}), {}), ""}}}), Error);
}

TEST(CompareMethods, AllSeeTheSameInAHaze) {
    for (const char* probe : {"", "windows"}) {
        Scene scene = haze();
        scene.lighting.probe.source = probe;
        scene.lighting.shading = Shading::phong;  // which the comparison leaves out
        const MethodComparison c = compared(scene, {Method::none, Method::spao, Method::visibility, Method::histogram});
        ASSERT_EQ(c.images.size(), 4u);
        ASSERT_EQ(c.references.size(), 1u);
        EXPECT_EQ(c.references[0].paths, 64);
        const double noise = c.references[0].noise;
        EXPECT_GT(noise, 0);
        for (const MethodImage& p : c.images) {
            EXPECT_NEAR(p.distance.rmse, noise, 0.1 * noise) << to_text(p.method) << probe;
            // Channels of a pixel differ together.
            EXPECT_LT(std::abs(p.distance.bias), 3 * noise / std::sqrt(48 * 36)) << to_text(p.method) << probe;
        }
    }
}

/// Particles of an opaque half space see half of the sky at most: E = ½ ∫ E_2(τ) exp(-τ) dτ = ½ (1 - ln 2). What
/// pictures do for surfaces would show 1.
TEST(CompareMethods, LightsParticlesAndNoSurfaces) {
    Scene scene;
    scene.volume = "sample:halfspace:32";
    scene.width = 48, scene.height = 36;
    scene.camera.elevation_deg = 90;
    scene.camera.zoom = 3;
    scene.transfer.points.emplace().points = {{0, {1, 1, 1}, 0}, {1, {1, 1, 1}, 0.9}};
    scene.illumination.reference.rays = 64;
    scene.illumination.reference.start_half_voxels = 0;
    scene.illumination.histogram.cache = "none";
    scene.illumination.histogram.radius = 8;
    scene.illumination.surfaces = SurfaceModel::none;
    const MethodComparison c = compared(scene, {Method::none, Method::spao, Method::visibility, Method::histogram});
    const auto centre = [](const Frame& frame) {
        double sum = 0;
        for (int y = 14; y < 22; ++y)
            for (int x = 20; x < 28; ++x) sum += frame.rgba[4 * (std::size_t(y) * frame.width + x)] / 64;
        return sum;
    };
    EXPECT_NEAR(centre(c.images[0].frame), 1, 0.01);
    EXPECT_NEAR(centre(c.references[0].image.frame), 0.5 * (1 - std::log(2.0)), 0.02);
    for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_LT(centre(c.images[i].frame), 0.6) << to_text(c.images[i].method);
        EXPECT_GT(centre(c.images[i].frame), 0.05) << to_text(c.images[i].method);
    }
}

TEST(CompareMethods, NaturalLightIsNearerTheGroundTruthThanNone) {
    Scene scene;
    scene.volume = "sample:cornell:32";
    scene.width = 64, scene.height = 48;
    scene.camera.fit = Fit::volume;
    scene.camera.azimuth_deg = 270, scene.camera.elevation_deg = 0;
    scene.transfer.points = sample_transfer_function("cornell");
    scene.illumination.reference.rays = 64;
    scene.lighting.probe.source = "sky";
    scene.illumination.surfaces = SurfaceModel::none;
    const MethodComparison c = compared(scene, {Method::none, Method::spao, Method::visibility});
    EXPECT_LT(c.images[1].distance.rmse, 0.7 * c.images[0].distance.rmse);
    EXPECT_LT(c.images[2].distance.rmse, 0.8 * c.images[1].distance.rmse);
    EXPECT_GT(c.images[2].light_bytes, 0u);
    EXPECT_GT(c.images[1].light_seconds, 0);
    const MethodComparison alone = compared(scene, {Method::visibility}, Device::cpu(1));
    EXPECT_EQ(alone.images[0].distance.rmse, c.images[2].distance.rmse);
}

/// Matte, convex, under white light: whatever light it is that a method follows, a ball shows its colour.
TEST(CompareMethods, JudgesPicturesAsTheyAreShown) {
    Scene scene;
    scene.volume = "sample:ball:64";
    scene.width = 96, scene.height = 96;
    scene.transfer.points.emplace().points = {{60, {0.8, 0.8, 0.8}, 0}, {140, {0.8, 0.8, 0.8}, 0.95}};
    scene.transfer.points->rgb_space = RgbSpace::linear;
    scene.illumination.reference.rays = 64;
    scene.lighting.specular = 0;
    const MethodComparison c = compared(scene, {Method::transport, Method::spao, Method::visibility, Method::none});
    ASSERT_EQ(c.references.size(), 3u);
    EXPECT_EQ(c.references[0].light, "scattered until it has left");
    EXPECT_EQ(c.references[1].light, "white, scattered once");
    EXPECT_EQ(c.references[2].light, "scattered once");
    for (const auto& [image, reference] : {std::pair{0, 0}, {1, 1}, {2, 2}, {3, 1}})
        EXPECT_EQ(c.images[std::size_t(image)].reference, std::size_t(reference));
    const auto centre = [](const Frame& frame) { return frame.rgba[4 * (48 * 96 + 48)]; };
    for (const MethodReference& reference : c.references) EXPECT_NEAR(centre(reference.image.frame), 0.8, 0.02);
    for (const MethodImage& image : c.images)
        EXPECT_LT(image.block_error, image.method == Method::spao ? 0.25 : 0.05) << to_text(image.method);
    scene.illumination.surfaces = SurfaceModel::none;
    const MethodComparison particles = compared(scene, {Method::transport, Method::visibility});
    ASSERT_EQ(particles.references.size(), 1u);
    EXPECT_LT(centre(particles.references[0].image.frame), 0.4);
    // A darker probe darkens what is lit by it; occlusion is judged without it.
    scene.illumination.surfaces = {};
    scene.lighting.probe.exposure = -1;
    const MethodComparison darker = compared(scene, {Method::visibility, Method::spao});
    EXPECT_NEAR(centre(darker.references[0].image.frame), 0.4, 0.01);
    EXPECT_NEAR(centre(darker.references[1].image.frame), 0.8, 0.02);
}

TEST_F(MethodsTool, TellsATableAndWritesAPageWithItsSheet) {
    const std::string options = " --size 48x36 --reference-rays 4 --quiet";
    const Said said = tool("compare sample:cornell:16 --methods spao,reference,none -o page.html" + options);
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_NE(said.out.find("\nspao "), std::string::npos) << said.out;
    EXPECT_NE(said.out.find("\nnone "), std::string::npos);
    EXPECT_NE(said.out.find("\nreference (light white, scattered once): 4 paths a pixel"), std::string::npos);
    EXPECT_EQ(files(), "page.html page.png");
    EXPECT_EQ(read_png(folder / "page.png").width, 8 + 3 * 56);
    const std::string page = read("page.html");
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing from elsewhere";
    const Said as_json = tool("compare sample:cornell:16 --methods spao --json" + options);
    const auto json = nlohmann::json::parse(as_json.out);
    EXPECT_EQ(json["methods"][0]["method"], "spao");
    EXPECT_EQ(json["references"][0]["paths"], 4);
    EXPECT_GT(json["methods"][0]["rmse"], 0);
}

TEST_F(MethodsTool, HoldsLimits) {
    const std::string line = "compare sample:cornell:16 --methods none,spao --size 32x32 --reference-rays 2 --quiet ";
    EXPECT_EQ(tool(line + "--fail-above rmse=10").code, 0);
    const Said broken = tool(line + "--fail-below ssim=2 -o page.html");
    EXPECT_EQ(broken.code, 5);
    EXPECT_NE(broken.err.find("none's ssim"), std::string::npos) << broken.err;
    EXPECT_NE(broken.err.find("spao's ssim"), std::string::npos);
    EXPECT_EQ(files(), "page.html page.png") << "what was found is shown";
}

TEST_F(MethodsTool, RefusesWhatItDoesNotUnderstand) {
    const auto refused = [&](const std::string& arguments, const std::string& sentence) {
        const Said said = tool("compare " + arguments);
        EXPECT_EQ(said.code, 2) << arguments;
        EXPECT_NE(said.err.find(sentence), std::string::npos) << said.err;
    };
    refused("sample:ball:16 --methods spoa", "did you mean 'spao'");
    refused("sample:ball:16 --methods spao,", "--methods spao,");
    refused("sample:ball:16 other.nrrd --methods spao", "what is other.nrrd");
    refused("--methods spao", "give either a VOLUME or --scene");
    refused("sample:ball:16 --methods spao -o page.pdf", "page.pdf");
    refused("sample:ball:16 --methods spao --mode mip", "mode dvr");
    refused("sample:ball:16 --methods spao --fail-above rsme=1", "did you mean 'rmse'");
    refused("a.png b.png --zoom 2", "only --methods");
    EXPECT_EQ(files(), "");
}
