// Frames that stay on the GPU until they are encoded, against the CPU's.
#include <cstdlib>

#include "cuda_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A frame of a volume with a sky behind it, or without.
struct Sight {
    ColorMode color = ColorMode::linear;
    bool with_sky = false;
    Projection projection = Projection::perspective;

    DeviceFrame by(const Device& device) const {
        const Volume volume = shells_of<std::uint8_t>(40);
        Lighting lighting{.shading = Shading::phong};
        lighting.probe = {.source = "sky", .rotation_deg = 40, .exposure = -1, .background = with_sky};
        lighting.loaded_probe = load_probe("sky");
        const Medium medium = classify(upload(device, volume), two_materials(), {.color = color});
        const Camera camera = make_camera({.projection = projection}, volume.geometry, volume.dimensions);
        DeviceFrame frame(61, 47);
        Progress progress;
        raycast(device, medium, {}, lighting, camera, {}, frame, progress);
        return frame;
    }
};

/// Of a GPU, codes may be one off where light lies between two.
void expect_same_image(const Image& found, const Image& expected, const std::string& what) {
    ASSERT_EQ(found.pixels.size(), expected.pixels.size()) << what;
    EXPECT_EQ(found.has_alpha, expected.has_alpha);
    int worst = 0;
    for (std::size_t i = 0; i < found.pixels.size(); ++i)
        worst = std::max(worst, std::abs(int(found.pixels[i]) - int(expected.pixels[i])));
    EXPECT_LE(worst, tolerance > 0 ? 1 : 0) << what;
}

std::vector<ToneMap> tones(ColorMode color) {
    std::vector<ToneMap> all;
    for (const bool transparent : {false, true})
        for (const Tone tone : {Tone::none, Tone::aces})
            for (const double stops : {0.0, 1.5}) all.push_back({{0.2, 0.5, 0.9}, transparent, color, tone, stops});
    return all;
}

}  // namespace

TEST_F(Gpus, DevelopTheFramesThatTheyHold) {
    for (const ColorMode color : {ColorMode::linear, ColorMode::display}) {
        const DeviceFrame expected = Sight{.color = color}.by(cpu()), frame = Sight{.color = color}.by(gpu);
        EXPECT_FALSE(expected.on_gpu());
        for (const ToneMap& tone : tones(color)) {
            const std::string what =
                fmt::format("{} {} {} {}", int(color), tone.transparent, int(tone.tone), tone.exposure_stops);
            expect_same_image(develop(frame, tone), develop(expected, tone), what);
        }
        EXPECT_TRUE(frame.on_gpu());
        const Image before = develop(frame, {.color = color});
        EXPECT_EQ(difference(frame.read(), expected.read(), tolerance).pixels_beyond, 0);
        EXPECT_FALSE(frame.on_gpu());
        expect_same_image(develop(frame, {.color = color}), before, "once it was read");
    }
}

TEST_F(Gpus, PutTheProbeBehind) {
    for (const ColorMode color : {ColorMode::linear, ColorMode::display})
        for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
            const Sight sight{color, true, projection};
            const DeviceFrame expected = sight.by(cpu()), frame = sight.by(gpu);
            EXPECT_TRUE(frame.on_gpu());
            EXPECT_EQ(difference(frame.read(), expected.read(), tolerance).pixels_beyond, 0);
            EXPECT_EQ(mean_alpha(frame.read()), 1);
        }
}

TEST_F(Gpus, KeepTheFramesOfPaths) {
    const Volume volume = shells_of<std::uint8_t>(24);
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    IlluminationSettings light{.method = Method::reference};
    light.reference.rays = 5;
    Progress progress;
    for (const bool with_sky : {false, true}) {
        const Lighting lighting{.probe = {.source = "sky", .background = with_sky}, .loaded_probe = load_probe("sky")};
        light.surfaces = with_sky ? SurfaceModel::automatic : SurfaceModel::none;
        std::vector<Image> previews[2];
        DeviceFrame frames[2];
        for (const bool on_gpu : {false, true}) {
            const Device device = on_gpu ? gpu : cpu();
            const Medium medium = classify(upload(device, volume), two_materials(), {});
            frames[on_gpu].resize(61, 47);
            trace_paths(device, medium, lighting, camera, {}, light, frames[on_gpu], progress,
                        [&](const DeviceFrame& frame, const PathStatistics&) {
                            EXPECT_EQ(frame.on_gpu() != nullptr, on_gpu);
                            previews[on_gpu].push_back(develop(frame, {}));
                        });
        }
        ASSERT_EQ(previews[1].size(), previews[0].size());
        for (std::size_t i = 0; i < previews[0].size(); ++i) expect_same_image(previews[1][i], previews[0][i], "early");
        EXPECT_TRUE(frames[1].on_gpu());
        EXPECT_EQ(difference(frames[1].read(), frames[0].read(), tolerance).pixels_beyond, 0);
        EXPECT_EQ(mean_alpha(frames[0].read()) == 1, with_sky);
    }
}

TEST_F(Gpus, GiveSessionsImagesAndFramesThatAreAskedFor) {
    Scene scene;
    scene.width = 61, scene.height = 47;
    scene.transfer.points = two_materials();
    scene.lighting.probe = {.source = "studio", .background = true};
    Progress progress;
    Session expected(cpu()), session(gpu);
    for (Session* each : {&expected, &session}) each->show(shells_of<std::uint8_t>(40), progress);
    expect_same_image(session.render(scene, progress), expected.render(scene, progress), "rendered");
    scene.output.tone = Tone::aces;
    expect_same_image(session.render(scene, progress), expected.render(scene, progress), "developed anew");
    EXPECT_EQ(difference(session.frame(), expected.frame(), tolerance).pixels_beyond, 0);
    scene.output.transparent = true;
    expect_same_image(session.render(scene, progress), expected.render(scene, progress), "once it was read");
    expect_same_image(session.preview(scene, progress), expected.preview(scene, progress), "drafted");
}

#ifdef CHIARO_CUDA_EMULATED
TEST_F(Gpus, BringBackNoMoreThanTheImage) {
    const auto brought = [](auto&& act) {
        const std::size_t before = cuda_emulated::gpu().downloaded_bytes;
        act();
        return cuda_emulated::gpu().downloaded_bytes - before;
    };
    constexpr std::size_t pixels = 61 * 47;
    DeviceFrame frame;
    const Device plain = Device::cuda(0, cpu());
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(plain, volume), two_materials(), {});
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    Progress progress;
    frame.resize(61, 47);
    const auto counts = brought([&] { raycast(plain, medium, {}, {}, camera, {}, frame, progress); });
    EXPECT_LE(counts, 8192u);
    EXPECT_EQ(brought([&] { develop(frame, {}); }), 3 * pixels);
    EXPECT_EQ(brought([&] { develop(frame, {.transparent = true}); }), 4 * pixels);
    EXPECT_EQ(brought([&] { frame.read(); }), 16 * pixels);
    EXPECT_EQ(brought([&] { frame.read(); }), 0u);

    IlluminationSettings light{.method = Method::reference};
    light.reference.rays = 1;
    const Lighting sky{.probe = {.source = "sky", .background = true}, .loaded_probe = load_probe("sky")};
    const auto paths = brought([&] { trace_paths(plain, medium, sky, camera, {}, light, frame, progress); });
    EXPECT_LE(paths, 8192u + pixels / 4) << "what was counted, and the noise";
    EXPECT_EQ(brought([&] { develop(frame, {}); }), 3 * pixels);
}
#endif
