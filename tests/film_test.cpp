// Films: keyframes met exactly, motion between them, files of them, and the tool.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tool_case.h"

using namespace chiaro;

namespace {

Scene scene_with(double azimuth, double exposure = 0) {
    Scene scene = scene_of_volume("sample:ball:16");
    scene.camera.by_frame = false;
    scene.camera.azimuth_deg = azimuth, scene.output.exposure_stops = exposure;
    scene.camera.fit = Fit::volume;
    return scene;
}

Film film_of(std::vector<Keyframe> keys, double fps = 10) {
    Film film;
    film.fps = fps, film.width = 32, film.height = 24;
    film.keys = std::move(keys);
    return film;
}

Scene at(const Film& film, int frame) { return frame_of(film, Geometry(), {16, 16, 16}, frame); }

}  // namespace

class FilmFiles : public FolderTest {};
class FilmTool : public ToolTest {};

TEST(Film, KeysAreMetExactlyAndTurntablesTurnEvenly) {
    const Film film = film_of({{0, scene_with(0)}, {1, scene_with(120)}, {2, scene_with(-120)}, {3, scene_with(0)}});
    ASSERT_EQ(frame_count(film), 31);
    for (int frame = 0; frame <= 30; ++frame) {
        const double turned = at(film, frame).camera.azimuth_deg;
        EXPECT_NEAR(std::remainder(turned - 12.0 * frame, 360), 0, 1e-9) << frame;
    }
    EXPECT_EQ(at(film, 10).camera.azimuth_deg, 120);
    EXPECT_EQ(at(film, 20).camera.azimuth_deg, -120);
    EXPECT_EQ(at(film, 0).width, 32);
    EXPECT_EQ(frame_count(film_of({{5, scene_with(0)}})), 1);
    EXPECT_EQ(at(film_of({{5, scene_with(7)}}), 0).camera.azimuth_deg, 7);
}

TEST(Film, ThePathHasNoCorners) {
    const Film film =
        film_of({{0, scene_with(0)}, {1, scene_with(90)}, {3, scene_with(60)}, {4, scene_with(150)}}, 1000);
    const auto azimuth = [&](int frame) { return at(film, frame).camera.azimuth_deg; };
    for (const int key : {1000, 3000}) {
        const double before = azimuth(key) - azimuth(key - 1), after = azimuth(key + 1) - azimuth(key);
        EXPECT_NEAR(before, after, 0.002) << key;
    }
}

TEST(Film, NumbersOfSettingsChangeEvenlyAndTheRestHolds) {
    Scene a = scene_with(0, -1), b = scene_with(0, 1);
    a.clip.planes = {{{1, 0, 0}, 0}}, b.clip.planes = {{{1, 0, 0}, 10}};
    b.clip.box = {0.5, 1, 0, 1, 0, 1};
    a.lighting.probe.rotation_deg = 0, b.lighting.probe.rotation_deg = 350;
    a.mode = Mode::dvr, b.mode = Mode::mip;
    a.sampling.samples_per_pixel = 1, b.sampling.samples_per_pixel = 9;
    a.iso = {{100, Rgb{1, 0, 0}, 0.5}}, b.iso = {{120, Rgb{1, 0, 0}, 1}};
    const Film film = film_of({{0, a}, {1, b}});
    const Scene half = at(film, 5);
    EXPECT_NEAR(half.output.exposure_stops, 0, 1e-12);
    EXPECT_NEAR(half.clip.planes.at(0).d, 5, 1e-12);
    ASSERT_TRUE(at(film, 4).iso.size() == 1);
    EXPECT_NEAR(at(film, 4).iso[0].value, 108, 1e-9);
    EXPECT_NEAR(half.lighting.probe.rotation_deg, 175, 1e-9);
    EXPECT_EQ(half.mode, Mode::dvr);
    EXPECT_EQ(half.sampling.samples_per_pixel, 1);
    const Scene last = at(film, 10);
    EXPECT_EQ(last.mode, Mode::mip);
    EXPECT_EQ(last.clip.box, b.clip.box);
    EXPECT_EQ(last.sampling.samples_per_pixel, 9);
}

TEST(Film, FunctionsMovePointByPointOrFade) {
    TransferFunction few, moved, more;
    few.points = {{0, {1, 0, 0}, 0}, {100, {1, 0, 0}, 1}};
    moved.points = {{50, {0, 0, 1}, 0}, {200, {0, 0, 1}, 0.5}};
    more.points = {{0, {0, 1, 0}, 0.5}, {50, {0, 1, 0}, 0}, {100, {0, 1, 0}, 0.5}};
    Scene a = scene_with(0), b = a, c = a;
    a.transfer.points = few, b.transfer.points = moved, c.transfer.points = more;
    const Scene half = at(film_of({{0, a}, {1, b}}), 5);
    ASSERT_EQ(half.transfer.points->points.size(), 2u);
    EXPECT_NEAR(half.transfer.points->points[0].value, 25, 1e-12);
    EXPECT_NEAR(half.transfer.points->points[1].opacity, 0.75, 1e-12);
    const Scene faded = at(film_of({{0, a}, {1, c}}), 5);
    for (double v = 0; v <= 100; v += 1) {
        const double expected = 0.5 * evaluate(few, v).opacity + 0.5 * evaluate(more, v).opacity;
        EXPECT_NEAR(evaluate(*faded.transfer.points, v).opacity, expected, 1e-9) << v;
    }
}

TEST(Film, AnEyeTurnsAboutItsTargetAtItsDistance) {
    Scene a = scene_with(0), b = a;
    a.camera.eye = Vec3{50, 7, 7}, a.camera.target = Vec3{7, 7, 7};
    b.camera.eye = Vec3{7, 50, 7}, b.camera.target = Vec3{7, 7, 7};
    const Film film = film_of({{0, a}, {1, b}});
    for (int frame = 0; frame <= 10; ++frame) {
        const CameraSettings camera = at(film, frame).camera;
        EXPECT_NEAR(length(*camera.eye - *camera.target), 43, 1e-9);
        EXPECT_NEAR(std::atan2(camera.eye->y - 7, camera.eye->x - 7), radians(9.0 * frame), 1e-9);
    }
    // From an orbit to an eye: where the orbit's eye is.
    const Film mixed = film_of({{0, scene_with(30)}, {1, a}});
    const Camera orbit = make_camera(scene_with(30).camera, Geometry(), {16, 16, 16});
    const Camera first = make_camera(at(mixed, 0).camera, Geometry(), {16, 16, 16});
    EXPECT_LT(length(first.eye - orbit.eye), 1e-9);
    EXPECT_NO_THROW(make_camera(at(mixed, 5).camera, Geometry(), {16, 16, 16}));
}

TEST(Film, AFileComesBackAndWrongOnesAreASentence) {
    const Film film = film_of({{0, scene_with(10, 0.1)}, {2.5, scene_with(20)}}, 12.5);
    std::vector<std::string> unknown;
    const Film again = parse_film(to_json(film), {}, {}, unknown);
    EXPECT_EQ(to_json(again), to_json(film));
    EXPECT_TRUE(unknown.empty());
    const auto refused = [&](const std::string& json, const std::string& part) {
        try {
            parse_film(json, {}, {}, unknown);
            ADD_FAILURE() << json;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input);
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    const std::string scene = R"({"chiaro": 1, "volume": {"file": "sample:ball"}})";
    refused("{", "JSON");
    refused("[]", "\"film\": 1");
    refused(R"({"film": 1, "keys": []})", "keys");
    refused(R"({"film": 1, "keys": [{"at": 0}]})", "keys[0]");
    refused(R"({"film": 1, "fps": 0, "keys": [{"scene": )" + scene + "}]}", "fps");
    refused(R"({"film": 1, "size": [1, 99999], "keys": [{"scene": )" + scene + "}]}", "size");
    refused(R"({"film": 1, "keys": [{"at": 1, "scene": )" + scene + R"(}, {"at": 1, "scene": )" + scene + "}]}",
            "keys[1].at");
    refused(R"({"film": 1, "keys": [{"at": 0, "scene": )" + scene + R"(}, {"at": 9e5, "scene": )" + scene + "}]}",
            "100000");
    refused(R"({"film": 1, "keys": [{"scene": )" + scene + R"(}, {"scene": {"volume": {"file": "sample:slab"}}}]})",
            "volume");
    refused(R"({"film": 1, "keys": [{"scene": {"volume": {"file": "sample:ball"}, "sampling": {"step": 0}}}]})",
            "sampling.step");
}

TEST_F(FilmTool, WritesItsFramesAndGoesOnWhereItWasStopped) {
    const auto run = [&](const std::string& arguments) {
        return std::system((built("chiaro") + " render --quiet " + arguments + " 2>/dev/null").c_str());
    };
    const std::filesystem::path file = folder / "film.json";
    const Film film = film_of({{0, scene_with(0)}, {0.4, scene_with(90)}});
    std::ofstream(file) << to_json(film);
    const auto frame = [&](int i) { return folder / fmt::format("f-{:02}.png", i); };
    const std::string command = "--film " + file.string() + " -o " + (folder / "f-{frame:02}.png").string();
    ASSERT_EQ(run(command), 0);
    Progress progress;
    for (int i = 0; i < 5; ++i) {
        const Image expected = render_image(Device::cpu(1), at(film, i), progress);
        EXPECT_TRUE(read_png(frame(i)).pixels == expected.pixels) << i;
    }
    EXPECT_FALSE(std::filesystem::exists(frame(5)));
    // A frame that is there is left; one that is missing, cut or of another scene is made again.
    const auto written = std::filesystem::last_write_time(frame(1));
    std::filesystem::remove(frame(2));
    std::filesystem::resize_file(frame(3), 100);
    std::filesystem::copy_file(frame(0), frame(4), std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(run(command), 0);
    EXPECT_EQ(std::filesystem::last_write_time(frame(1)), written);
    for (int i = 2; i < 5; ++i) {
        const Image expected = render_image(Device::cpu(1), at(film, i), progress);
        EXPECT_TRUE(read_png(frame(i)).pixels == expected.pixels) << i;
    }
    EXPECT_NE(run("--film " + file.string() + " -o " + (folder / "one.png").string()), 0);
    EXPECT_NE(run("--film " + file.string() + " --step 1 -o " + (folder / "f-{frame}.png").string()), 0);
    if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
    ASSERT_EQ(run("--film " + file.string() + " -o " + (folder / "film.mp4").string()), 0);
    EXPECT_GT(std::filesystem::file_size(folder / "film.mp4"), 500u);
}

TEST_F(FilmFiles, AVideoIsWholeOrNotThere) {
    if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg";
    const std::filesystem::path file = folder / "film.webm";
    const Image picture{33, 21, false, std::vector<std::uint8_t>(3 * 33 * 21, 90)};
    {
        VideoWriter video(file, 33, 21, 25);
        video.write(picture);
    }  // not finished
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    VideoWriter video(file, 33, 21, 25);
    for (int i = 0; i < 10; ++i) video.write(picture);
    EXPECT_THROW(video.write(Image{2, 2, false, std::vector<std::uint8_t>(12)}), Error);
    video.finish();
    EXPECT_TRUE(std::filesystem::exists(file));
    EXPECT_THROW(VideoWriter(folder / "film.avi", 3, 3, 25), Error);
    EXPECT_THROW(
        {
            VideoWriter nowhere(folder / "none" / "film.mp4", 32, 32, 25);
            for (int i = 0; i < 200; ++i) nowhere.write(Image{32, 32, false, std::vector<std::uint8_t>(3072)});
            nowhere.finish();
        },
        Error);
}
