// Light probes from files, in scenes and behind the volume.
#include <chiaro/chiaro.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "fixtures.h"
#include "illumination/probe/data.h"
#include "image/exr.h"
#include "image/hdr.h"
#include "tool_case.h"

using namespace chiaro;
using chiaro::testing::tested_device;
namespace shots = chiaro::testing;

namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string header(int width, int height) {
    return "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n-Y " + std::to_string(height) + " +X " +
           std::to_string(width) + "\n";
}

/// Pixel i of a picture: runs and changes, every exponent that keeps a float finite, zero too.
std::array<std::uint8_t, 4> rgbe(int i) {
    const int block = i / 5 % 50;
    return {std::uint8_t(128 + block), std::uint8_t(3 * block), std::uint8_t(i % 7 * 30),
            std::uint8_t(block % 11 * 23)};
}

std::string flat(int width, int height) {
    std::string file = header(width, height);
    for (int i = 0; i < width * height; ++i)
        for (const auto value : rgbe(i)) file += char(value);
    return file;
}

std::string run_length_coded(int width, int height) {
    std::string file = header(width, height);
    for (int y = 0; y < height; ++y) {
        file += {2, 2, char(width >> 8), char(width & 255)};
        for (int component = 0; component < 4; ++component)
            for (int x = 0; x < width;) {
                const auto at = [&](int column) { return char(rgbe(y * width + column)[component]); };
                int run = 1;
                while (x + run < width && run < 127 && at(x + run) == at(x)) ++run;
                if (run > 2)
                    file += {char(128 + run), at(x)};
                else
                    for (run = 0; x + run < width && run < 3; ++run) file += {1, at(x + run)};
                x += run;
            }
    }
    return file;
}

void expect_exact(const Probe& probe, int width, int height) {
    ASSERT_EQ(probe.width(), width);
    ASSERT_EQ(probe.height(), height);
    for (int i = 0; i < width * height; ++i)
        for (int c = 0; c < 3; ++c) {
            const auto pixel = rgbe(i);
            const double exact = pixel[3] ? std::ldexp(double(pixel[c]), pixel[3] - 136) : 0;
            ASSERT_EQ(double(probe.rgb()[3 * i + c]), exact) << i << " " << c;
        }
}

std::string refusal(const std::string& file) {
    try {
        decode_hdr(bytes_of(file), "x.hdr");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_TRUE(std::string(error.what()).starts_with("x.hdr: is a broken Radiance picture: ")) << error.what();
        return error.what();
    }
    return "";
}

Rgb mean_of(const Probe& probe) {
    Rgb mean;
    for (int c = 0; c < 3; ++c) mean[c] = probe.data().sh[c][0] / std::sqrt(4 * std::numbers::pi);
    return mean;
}

class ProbeFile : public FolderTest {};
class ProbeTool : public ToolTest {};

}  // namespace

TEST(Hdr, DecodesFlatAndCodedImagesExactly) {
    for (auto [width, height] : {std::pair(7, 5), {8, 4}, {40, 20}, {300, 11}}) {
        expect_exact(decode_hdr(bytes_of(flat(width, height)), "x"), width, height);
        if (width >= 8) expect_exact(decode_hdr(bytes_of(run_length_coded(width, height)), "x"), width, height);
    }
}

TEST(Hdr, DecodesOldRuns) {
    // A pixel, repeated 3 and then 1 × 256 times, as pictures from before 1991 have it.
    const std::string file = header(260, 1) + std::string("\x80\x40\x20\x81\1\1\1\3\1\1\1\1", 12);
    const Probe probe = decode_hdr(bytes_of(file), "x");
    for (int i = 0; i < 260; ++i) ASSERT_EQ(probe.rgb()[3 * i + 2], 0.25f) << i;
}

TEST(Hdr, RefusesBrokenFilesInOneSentence) {
    const std::string good = run_length_coded(40, 20);
    for (std::size_t length = 2; length < good.size(); length += 13) EXPECT_NE(refusal(good.substr(0, length)), "");
    const auto with = [](const std::string& size, const std::string& format = "32-bit_rle_rgbe") {
        return refusal("#?RADIANCE\nFORMAT=" + format + "\n\n" + size + "\n");
    };
    EXPECT_NE(with("-Y 20000 +X 20000").find("more than 100 megapixels"), std::string::npos);
    EXPECT_NE(with("-Y 1 +X 70000").find("65536 pixels a side"), std::string::npos);
    EXPECT_NE(with("-Y 10 +X 20").find("ends too early"), std::string::npos);
    EXPECT_NE(with("-Y 10 +X 20", "32-bit_rle_xyze").find("format"), std::string::npos);
    for (const char* size : {"", "+Y 10 +X 20", "-Y 0 +X 5", "-Y -3 +X 5", "-Y 5 +X", "-Y 99999999999 +X 2",
                             "+X 2 -Y 2", "-Y 8.5 +X 4", "-Y 8 +X 4.5", "-Y 8 -Y 9 +X 4", "-Y 8 +X 4 +X 4"})
        EXPECT_NE(with(size), "") << size;
    EXPECT_NE(refusal(header(300, 1) + std::string("\2\2\1\x2c\xff\0\0\0", 8)), "");    // too short
    EXPECT_NE(refusal(header(10, 1) + std::string("\2\2\0\x0a\xff\5\xff\5", 8)), "");   // a run beyond the row
    EXPECT_NE(refusal(header(10, 1) + std::string("\2\2\0\x0a\0\0\0\0\0\0", 10)), "");  // a run of nothing
    EXPECT_NE(refusal(header(10, 1) + std::string("\1\1\1\5\1\1\1\5", 8)), "");         // repeats what is not there
    EXPECT_NE(refusal(header(10, 1) + std::string("\3\1\1\5\1\1\1\xff\1\1\1\xff", 12)), "");
}

TEST(Hdr, SurvivesAnyChange) {
    const std::string good = run_length_coded(40, 20);
    std::mt19937 random(1);
    for (int i = 0; i < 3000; ++i) {
        std::string mangled = good;
        for (int k = 0; k < 3; ++k) mangled[random() % (i % 2 ? 90 : mangled.size())] = char(random());
        try {
            const Probe probe = decode_hdr(bytes_of(mangled), "x");
            for (const float radiance : probe.rgb()) ASSERT_TRUE(radiance >= 0 && std::isfinite(radiance));
        } catch (const Error&) {
        }
    }
}

TEST_F(ProbeFile, IsReadFromHdrAndExr) {
    std::ofstream(folder / "a.hdr", std::ios::binary) << run_length_coded(40, 20);
    expect_exact(load_probe(folder / "a.hdr"), 40, 20);
    Frame frame(3, 2);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] = float(i) / 4;
    write_exr(frame, folder / "a.exr");
    const Probe probe = load_probe(folder / "a.exr");
    ASSERT_EQ(probe.rgb().size(), 18u);
    EXPECT_EQ(probe.rgb()[4], 1.25f);
}

TEST_F(ProbeTool, RefusalsAreOneSentenceWithTheRightCode) {
    const auto said = [&](const std::string& source) {
        const Said s = tool("render sample:ball:8 -o a.png --size 8x8 --quiet --probe " + source);
        return std::to_string(s.code) + " " + s.err;
    };
    EXPECT_EQ(said("stdio"),
              "2 chiaro: no light probe 'stdio': it is a file (.hdr, .exr) or one of white, sky, studio, "
              "windows, three-point, lights; did you mean 'studio'?\n");
    EXPECT_EQ(said("none.hdr"), "3 chiaro: cannot read 'none.hdr': No such file or directory\n");
    write("text.hdr", "no picture");
    EXPECT_EQ(said("text.hdr"), "3 chiaro: text.hdr: is neither a Radiance picture (.hdr) nor an OpenEXR file\n");
    write("cut.hdr", "#?RADIANCE\n");
    EXPECT_EQ(said("cut.hdr"), "3 chiaro: cut.hdr: is a broken Radiance picture: the header does not end\n");
    EXPECT_EQ(said("sky --probe-exposure 99"), "2 chiaro: --probe-exposure 99: must be -32 to 32 stops\n");
    const Said bare = tool("render sample:ball:8 -o a.png --size 8x8 --quiet --background probe");
    EXPECT_EQ(bare.code, 2);
    EXPECT_NE(bare.err.find("a probe to show is missing"), std::string::npos) << bare.err;
}

TEST(ProbeScene, KeepsFilesAndNames) {
    std::vector<std::string> unknown;
    const auto parse = [&](const std::string& more) {
        return parse_scene(R"({"volume": {"file": "v.nrrd"}, )" + more + "}", "folder", "", unknown);
    };
    const Scene file = parse(R"("probe": {"file": "p.hdr", "rotation": 90, "exposure": -1}, "background": "probe")");
    EXPECT_EQ(file.lighting.probe, (ProbeSettings{"folder/p.hdr", 90, -1, true}));
    EXPECT_EQ(seen_from(file, "folder").lighting.probe.source, "p.hdr");
    EXPECT_NE(to_json(file).find("\"file\": \"folder/p.hdr\""), std::string::npos);
    const Scene preset = parse(R"("probe": {"preset": "sky", "background": true}, "background": [0, 1, 0])");
    EXPECT_EQ(preset.lighting.probe, (ProbeSettings{"sky", 0, {}, true}));
    EXPECT_EQ(preset.output.background, (Rgb{0, 1, 0}));
    EXPECT_EQ(seen_from(preset, "folder").lighting.probe.source, "sky");
    EXPECT_TRUE(unknown.empty());
    EXPECT_THROW(parse(R"("probe": {"preset": "sky", "file": "p.hdr"})"), Error);
    EXPECT_THROW(parse(R"("background": "probe")"), Error);
}

TEST(ProbeScene, IsLoadedOnceByASession) {
    Progress progress;
    Session session(tested_device());
    session.show(make_sample("ball", 8), progress);
    Scene scene;
    scene.width = scene.height = 8;
    scene.camera.fit = Fit::volume;
    const auto redone = [&] {
        session.render(scene, progress);
        std::string names;
        for (const auto& stage : session.stages())
            if (stage.seconds > 0) names += stage.name + " ";
        return names;
    };
    redone();
    scene.lighting.probe.source = "windows";
    EXPECT_EQ(redone(), "probe raycast develop ");
    scene.lighting.probe.rotation_deg = 10;
    EXPECT_EQ(redone(), "raycast develop ");
    scene.camera.azimuth_deg = 0;
    EXPECT_EQ(redone(), "raycast develop ");
    EXPECT_EQ(redone(), "");
}

TEST(RealProbes, HaveTheMeansThatTheirMakersState) {
    const char* data = std::getenv("CHIARO_DATA_DIR");
    if (!data) GTEST_SKIP() << "skipped: no data";
    struct Case {
        const char* name;
        Rgb mean;
    };
    const Case cases[] = {{"grace.hdr", {0.0224, 0.0124, 0.0153}},  {"grace.exr", {0.0224, 0.0124, 0.0153}},
                          {"studio.hdr", {1.97, 2.26, 2.55}},       {"sunrise.hdr", {1.65, 1.23, 0.579}},
                          {"apartment.hdr", {0.813, 0.703, 0.642}}, {"venice.hdr", {0.405, 0.65, 1.31}},
                          {"lab.hdr", {0.416, 0.588, 0.694}}};
    for (const auto& [name, mean] : cases) {
        const Rgb found = mean_of(load_probe(std::string(data) + "/probes/" + name));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], mean[c], 0.004 * mean[c]) << name;
    }
    // Stored upside down and not flipped: what is odd in z has the other sign.
    const auto up = load_probe(std::string(data) + "/probes/grace.hdr").data().sh[0];
    const auto down = load_probe(std::string(data) + "/probes/grace.exr").data().sh[0];
    for (int l = 0; l < max_bands; ++l)
        for (int m = -l; m <= l; ++m)
            EXPECT_NEAR(up[l * (l + 1) + m], ((l + m) % 2 ? -1 : 1) * down[l * (l + 1) + m], 0.01 * up[0]);
}

namespace {

/// Black, and one bright pixel.
Probe spot(int width, int height, int x, int y) {
    std::vector<float> rgb(std::size_t(3) * width * height);
    for (int c = 0; c < 3; ++c) rgb[3 * (std::size_t(y) * width + x) + c] = float(c + 1);
    return Probe(width, height, std::move(rgb));
}

shots::Shot empty_room(Probe probe) {
    shots::Shot shot;
    shot.tf = shots::constant(0);
    shot.lighting.loaded_probe = std::move(probe);
    shot.lighting.probe.background = true;
    shot.width = 160, shot.height = 120;
    shot.camera.fov_deg = 60;
    return shot;
}

const Volume& any_volume() {
    static const Volume volume = make_sample("ball", 16);
    return volume;
}

}  // namespace

TEST(Background, ShowsABrightPixelWhereTheRaySays) {
    const int width = 360, height = 180, x = 100, y = 75;
    const Probe probe = spot(width, height, x, y);
    const ProbeImage& image = probe.data().image;
    for (const Vec3 up : {Vec3{0, 0, 1}, {0, -1, 0}, {0.3, 0.5, -0.8}})
        for (const double rotation : {0.0, 110.0}) {
            shots::Shot shot = empty_room(probe);
            shot.lighting.probe.rotation_deg = rotation;
            shot.camera.up = up;
            const double azimuth = image.azimuth(x + 0.5) * 180 / std::numbers::pi + rotation;
            const double elevation = 90 - image.polar_angle(y + 0.5) * 180 / std::numbers::pi;
            // The camera looks the other way from where it stands; a little aside, so that nothing is hidden in
            // symmetry.
            shot.camera.azimuth_deg = azimuth + 180 + 12, shot.camera.elevation_deg = -elevation + 7;
            shot.camera.roll_deg = 20;
            const Frame frame = shot(any_volume());
            const Camera camera = make_camera(shot.camera, any_volume().geometry, any_volume().dimensions);
            const double degree = std::numbers::pi / 180;
            const Vec3 d = orbit_direction(azimuth * degree, elevation * degree, up);
            const double scale = frame.height / (2 * camera.half_height * dot(d, camera.forward));
            const double column = frame.width / 2.0 + scale * dot(d, camera.right);
            const double row = frame.height / 2.0 - scale * dot(d, camera.up);
            double sum = 0, mean_column = 0, mean_row = 0;
            for (int j = 0; j < frame.height; ++j)
                for (int i = 0; i < frame.width; ++i) {
                    const float* pixel = frame.rgba.data() + 4 * (std::size_t(j) * frame.width + i);
                    EXPECT_EQ(pixel[3], 1);
                    EXPECT_NEAR(pixel[2], 3 * pixel[0], 1e-6);
                    sum += pixel[0], mean_column += pixel[0] * (i + 0.5), mean_row += pixel[0] * (j + 0.5);
                }
            ASSERT_GT(sum, 1);
            EXPECT_NEAR(mean_column / sum, column, 0.3) << rotation;
            EXPECT_NEAR(mean_row / sum, row, 0.3) << rotation;
        }
}

TEST(Background, LiesBehindTheVolume) {
    shots::Shot shot = empty_room(builtin_probe("sky"));
    const Frame sky = shot(any_volume());
    shot.tf = shots::constant(0.05, {0.5, 0.2, 0.1});
    const Frame both = shot(any_volume());
    shot.device = tested_device();
    EXPECT_EQ(shot(any_volume()).rgba, both.rgba);  // whatever the number of threads
    shot.lighting.probe.background = false;
    const Frame volume = shot(any_volume());
    for (std::size_t i = 0; i < both.rgba.size(); ++i)
        ASSERT_NEAR(both.rgba[i], volume.rgba[i] + (1 - volume.rgba[i / 4 * 4 + 3]) * sky.rgba[i], 1e-5);
}

TEST(Background, IsExposedAndEncodedForTheDisplay) {
    shots::Shot shot = empty_room(builtin_probe("studio"));
    const Frame linear = shot(any_volume());
    shot.shape.color = ColorMode::display;
    shot.lighting.probe.exposure = -2;
    const Frame display = shot(any_volume());
    for (std::size_t i = 0; i < linear.rgba.size(); ++i) {
        const double light = linear.rgba[i] / 4;
        const double encoded = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
        ASSERT_NEAR(display.rgba[i], i % 4 == 3 ? 1 : encoded, 1e-5);
    }
}

TEST(Background, OfAnOrthographicCameraIsOneDirection) {
    shots::Shot shot = empty_room(builtin_probe("windows"));
    shot.camera.projection = Projection::orthographic;
    const Frame frame = shot(any_volume());
    for (std::size_t i = 4; i < frame.rgba.size(); ++i) ASSERT_EQ(frame.rgba[i], frame.rgba[i - 4]);
}

TEST(Background, WrapsWithoutASeam) {
    // Looking at azimuth 180°, where the picture's left and right border meet.
    std::vector<float> rgb;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) rgb.insert(rgb.end(), 3, float(1 - std::cos((x + 0.5) / 32 * std::numbers::pi)));
    shots::Shot shot = empty_room(Probe(64, 32, rgb));
    shot.camera.azimuth_deg = 0, shot.camera.elevation_deg = 0;
    const Frame frame = shot(any_volume());
    const float* row = frame.rgba.data() + 4 * 60 * frame.width;
    for (int x = 1; x < frame.width; ++x) EXPECT_NEAR(row[4 * x], row[4 * x - 4], 0.01) << x;
    EXPECT_LT(row[4 * 80], 0.01);
}
