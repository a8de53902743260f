// How bright a probe from a file is: found from the probe alone, and remembered.
#include <chiaro/chiaro.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "illumination/probe/data.h"
#include "tool_case.h"

using namespace chiaro;

namespace {

/// Stops of a probe as if it came from a file.
double suitable(Probe probe) {
    Lighting lighting;
    lighting.probe.source = "some.hdr";
    lighting.loaded_probe = std::move(probe);
    return exposure_stops(lighting);
}

/// Black, and one bright pixel.
Probe small_light() {
    constexpr int width = 512, height = 256;
    std::vector<float> rgb(std::size_t(3) * width * height);
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * (90 * width + 200) + c] = float(c + 1);
    return Probe(width, height, std::move(rgb));
}

Probe even(float radiance) { return Probe(8, 4, std::vector<float>(3 * 8 * 4, radiance)); }

}  // namespace

/// Closed forms: an even light L has mean and largest E/π of L; one small light of mean M has the largest of 4 M.
TEST(ProbeExposure, SuitsTheLight) {
    for (const float radiance : {1e-4f, 0.45f, 1.0f, 3000.0f})
        EXPECT_NEAR(suitable(even(radiance)), std::log2(0.45 / radiance), 0.011) << radiance;
    const Probe small = small_light();
    double mean = 0;
    for (std::size_t c = 0; c < 3; ++c)
        mean += luminance_weights[c] * small.data().sh[c][0] / std::sqrt(4 * std::numbers::pi);
    EXPECT_NEAR(suitable(small), std::log2(1.2 / (4 * mean)), 0.02);
    EXPECT_EQ(suitable(even(0)), 0) << "black";
    EXPECT_EQ(suitable(even(1e-30f)), 32) << "no more than a flag may say";
    Lighting given;
    given.probe.source = "some.hdr", given.loaded_probe = even(7), given.probe.exposure = -3;
    EXPECT_EQ(exposure_stops(given), -3);
    for (const ProbeInfo& builtin : list_probes()) {
        Lighting lighting;
        lighting.probe.source = builtin.name, lighting.loaded_probe = builtin_probe(builtin.name);
        EXPECT_EQ(exposure_stops(lighting), 0) << builtin.name;
    }
}

TEST(ProbeExposure, IsRememberedByScenesAndPictures) {
    std::vector<std::string> unknown;
    const auto exposure_of = [&](const std::string& probe) {
        const std::string json = R"({"volume": {"file": "sample:ball"}, "probe": )" + probe + "}";
        const Scene scene = parse_scene(json, ".", {}, unknown);
        EXPECT_EQ(parse_scene(to_json(scene), ".", {}, unknown).lighting.probe, scene.lighting.probe) << probe;
        return scene.lighting.probe.exposure.stops;
    };
    EXPECT_EQ(exposure_of(R"({"file": "p.hdr"})"), std::nullopt);
    EXPECT_EQ(exposure_of(R"({"file": "p.hdr", "exposure": "auto"})"), std::nullopt);
    EXPECT_EQ(exposure_of(R"({"file": "p.hdr", "exposure": 0})"), 0);
    EXPECT_THROW(exposure_of(R"({"file": "p.hdr", "exposure": "more"})"), Error);
}

using ProbeExposureTool = ToolTest;

TEST_F(ProbeExposureTool, APictureRemakesItself) {
    std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n";
    for (int i = 0; i < 16; ++i) hdr += {char(100 + i), char(60), char(20), char(126 + i % 5)};
    std::ofstream(folder / "p.hdr", std::ios::binary) << hdr;
    const std::string picture = "render sample:ball:16 --size 24x18 --lighting visibility --probe p.hdr --quiet -o ";
    ASSERT_EQ(tool(picture + "a.png --stats a.json").code, 0);
    const auto probe = json("a.json")["settings"]["probe"];
    ASSERT_TRUE(probe["exposure"].is_number()) << probe;
    EXPECT_EQ(probe["exposure"], suitable(load_probe((folder / "p.hdr").string())));
    ASSERT_EQ(tool("render --scene a.png -o b.png --quiet").code, 0);
    EXPECT_EQ(read("a.png"), read("b.png"));
    ASSERT_EQ(tool(picture + "c.png --probe-exposure=-1").code, 0);
    EXPECT_NE(read("a.png"), read("c.png"));
}

/// A matte white ball in each light: its mean luminance lies within a factor 1.5 of .45, and one of albedo .8 is not
/// burnt out.
TEST(RealProbes, AreExposedToSuit) {
    const char* data = std::getenv("CHIARO_DATA_DIR");
    if (!data) GTEST_SKIP() << "skipped: no data";
    const std::string folder = std::string(data) + "/probes/";
    for (const std::string name : {"sky", "studio", "windows", "three-point", "grace.hdr", "studio.hdr", "sunrise.hdr",
                                   "apartment.hdr", "venice.hdr", "lab.hdr", "grace.exr"}) {
        Lighting lighting;
        lighting.probe.source = is_probe_name(name) ? name : folder + name;
        lighting.loaded_probe = load_probe(lighting.probe.source);
        const double gain = std::exp2(exposure_stops(lighting)), y_00 = std::sqrt(1 / (4 * std::numbers::pi));
        constexpr int normals = 4000;
        double mean = 0;
        int burnt = 0;
        for (int i = 0; i < normals; ++i) {
            const double z = 1 - (2.0 * i + 1) / normals, r = std::sqrt(1 - z * z), turn = i * 2.399963;
            const auto light = lighting.loaded_probe.data().lambert().at({r * std::cos(turn), r * std::sin(turn), z});
            double luminance = 0;
            for (std::size_t c = 0; c < 3; ++c)
                luminance += luminance_weights[c] * gain * light[c][0] / y_00 / std::numbers::pi;
            mean += luminance / normals;
            burnt += 0.8 * luminance >= 1;
        }
        EXPECT_GE(mean, 0.45 / 1.5) << name;
        EXPECT_LE(mean, 0.45 * 1.5) << name;
        EXPECT_LE(burnt, normals / 100) << name;
    }
    const auto stops = [&](const char* name) { return suitable(load_probe(folder + name)); };
    EXPECT_NEAR(std::exp2(stops("grace.exr") - stops("grace.hdr")), 1, 0.01);
}
