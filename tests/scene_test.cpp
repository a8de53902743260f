#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/scene.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using namespace chiaro;
namespace fs = std::filesystem;

namespace {

/// Parses a scene of "volume": {"file": "v.nrrd"} and more members.
Scene parse(const std::string& members, std::vector<std::string>* unknown = nullptr) {
    std::vector<std::string> keys;
    const Scene scene = parse_scene(R"({"volume": {"file": "v.nrrd"})" + (members.empty() ? "" : ", " + members) + "}",
                                    "folder", "", keys);
    if (unknown) *unknown = keys;
    return scene;
}

std::string refusal(const std::string& members) {
    try {
        parse(members);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        return error.what();
    }
    return "accepted";
}

/// A fresh folder, removed at the end.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("chiaro-scene-" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

}  // namespace

TEST(Scene, HasTheDocumentedDefaults) {
    const Scene scene = parse("");
    EXPECT_EQ(scene.volume, "folder/v.nrrd");
    EXPECT_EQ(scene.camera, CameraSettings());
    EXPECT_EQ(scene.illumination.method, Method::none);
    EXPECT_EQ(scene.interpolation, Interpolation::linear);
    EXPECT_EQ(parse(R"("sampling": {"interpolation": "exact"})").interpolation, Interpolation::linear);
    EXPECT_EQ(parse(R"("sampling": {"interpolation": "auto"})").interpolation, Interpolation::automatic);
    EXPECT_EQ(scene.output.color, ColorMode::linear);
}

TEST(Scene, ReadsTheKeptNames) {
    const Scene scene =
        parse(R"("camera": {"model": "orbit", "azimuth_deg": 1, "fit_scale": 0.5, "view_angle_deg": 40, "up": "-y"},
        "shading": {"enabled": false, "specular_power": 7, "light": [30, 20, "red"]}, "color": "display", "background": "transparent",
        "image": {"size": [640, 480]}, "sampling": {"step": 1, "no_skip_empty": true}, "window": [40, 400], "lighting": {"method": "none"})");
    EXPECT_EQ(scene.camera.zoom, 2);
    EXPECT_EQ(scene.camera.fov_deg, 40);
    EXPECT_EQ(scene.camera.up, (Vec3{0, -1, 0}));
    EXPECT_EQ(scene.lighting.shading, Shading::none);
    EXPECT_EQ(scene.lighting.shininess, 7);
    EXPECT_EQ(scene.lighting.lights[0].color, (Rgb{1, 0, 0}));
    EXPECT_EQ(scene.output.color, ColorMode::display);
    EXPECT_TRUE(scene.output.transparent);
    EXPECT_EQ(scene.width, 640);
    EXPECT_FALSE(scene.sampling.skip_empty);
    EXPECT_EQ(scene.transfer.window, std::pair(40.0, 400.0));
}

TEST(Scene, ReadsTransferFunctionsOfThreeKinds) {
    const Scene points = parse(
        R"("transfer_function": {"opacity_unit_mm": 2, "points": [{"value": 5, "rgb": [0, 0.5, 1], "opacity": 0.25,
                                                                   "name": "Leaves"}]})");
    ASSERT_TRUE(points.transfer.points);
    EXPECT_EQ(points.transfer.points->points[0].name, "Leaves");
    EXPECT_EQ(points.transfer.points->opacity_unit, 2);
    EXPECT_TRUE(points.transfer.points->opacity_unit_is_mm);
    EXPECT_FALSE(points.transfer.opacity_unit_mm);
    EXPECT_EQ(parse(R"("transfer_function": {"preset": "ct-bone"})").transfer.source, "ct-bone");
    EXPECT_EQ(parse(R"("transfer_function": {"file": "tf.json"})").transfer.source, "folder/tf.json");
}

TEST(Scene, ReportsUnknownKeysWithTheirPath) {
    std::vector<std::string> unknown;
    parse(R"("camera": {"azimut_deg": 1}, "mood": "bright", "bench": {"any": 1}, "conventions": {"x": 1}, "note": "n",
        "transfer_function": {"opacity_unit_distance": 1, "points": [{"value": 0, "rgb": [0, 0, 0], "opacity": 0, "glow": 1}]})",
          &unknown);
    EXPECT_EQ(unknown, (std::vector<std::string>{"camera.azimut_deg; did you mean 'azimuth_deg'?", "mood",
                                                 "transfer_function.points[0].glow"}));
}

TEST(Scene, RefusesInOneSentence) {
    EXPECT_EQ(refusal(R"("sampling": {"step": 0})"), "sampling.step 0: must be 0.001 to 100 voxels");
    EXPECT_EQ(refusal(R"("camera": {"fit_scale": 0})"), "camera.fit_scale 0: expected a number");
    EXPECT_EQ(refusal(R"("camera": 5)"), "camera: must be an object");
    EXPECT_EQ(refusal(R"("camera": {"model": "free"})"), "camera.model \"free\": must be \"orbit\"");
    EXPECT_EQ(refusal(R"("camera": {"eye": [1, 2, 3]})"), "camera: eye and target need each other");
    EXPECT_EQ(refusal(R"("image": {"size": [1024]})"), "image.size [1024]: expected WIDTHxHEIGHT");
    EXPECT_EQ(refusal(R"("image": {"size": {"w": 1}})"), "image.size {\"w\":1}: expected WIDTHxHEIGHT");
    EXPECT_EQ(refusal(R"("window": [0, -1])"), "window 0,-1: the width must be above 0");
    EXPECT_EQ(refusal(R"("threshold": [2, 1])"), "threshold 2,1: LO must not be above HI");
    EXPECT_EQ(refusal(R"("transfer_function": {"preset": "a", "file": "b"})"),
              "transfer_function: points, file and preset exclude each other");
    EXPECT_EQ(refusal(R"("transfer_function": {"preset": "a", "opacity_unit_mm": 1, "opacity_unit_distance": 1})"),
              "opacity unit: give it in voxels or in mm, not both");
    EXPECT_EQ(refusal(R"("chiaro": 2)"), "chiaro 2: this program reads scenes of version 1");
    std::vector<std::string> unknown;
    EXPECT_THROW(parse_scene("{}", "", "", unknown), Error);
    EXPECT_THROW(parse_scene("[1, 2", "", "", unknown), Error);
    EXPECT_THROW(parse_scene("3", "", "", unknown), Error);
    EXPECT_THROW(parse_scene(R"({"volume": "v.nrrd"})", "", "", unknown), Error);
}

TEST(Scene, SurvivesAnyText) {
    const std::string good =
        to_json(parse(R"("transfer_function": {"points": [{"value": 5, "rgb": [0, 0.5, 1], "opacity": 0.25}]})"));
    const std::string pieces[] = {"[", "{", "}", "\"", "null", "-1", "1e400", "[[", "true", "\xff", ",", "{\"a\":1}"};
    std::vector<std::string> unknown;
    for (std::size_t i = 0; i < good.size(); i += 3)
        for (const auto& piece : pieces) {
            const std::string text = good.substr(0, i) + piece + good.substr(std::min(good.size(), i + i % 7));
            try {
                parse_scene(text, "", "", unknown);
            } catch (const Error&) {
            }
        }
    EXPECT_THROW(parse_scene(std::string(1000000, '['), "", "", unknown), Error);
    EXPECT_THROW(parse_scene("{\"note\": " + std::string(1000000, '['), "", "", unknown), Error);
}

TEST(Scene, LooksForTheVolumeBesideItselfThenInTheData) {
    const Folder folder;
    fs::create_directories(folder.path / "data");
    std::ofstream(folder.path / "data" / "v.nrrd") << "x";
    std::ofstream(folder.path / "s.json") << R"({"volume": {"file": "v.nrrd"}})";
    std::vector<std::string> unknown;
    EXPECT_EQ(read_scene(folder.path / "s.json", "", unknown).volume, folder.path / "v.nrrd");
    EXPECT_EQ(read_scene(folder.path / "s.json", folder.path / "data", unknown).volume, folder.path / "data/v.nrrd");
    std::ofstream(folder.path / "v.nrrd") << "x";
    EXPECT_EQ(read_scene(folder.path / "s.json", folder.path / "data", unknown).volume, folder.path / "v.nrrd");
    EXPECT_EQ(parse_scene(R"({"volume": {"file": "sample:ball"}})", folder.path, "", unknown).volume, "sample:ball");
    EXPECT_THROW(read_scene(folder.path / "none.json", "", unknown), Error);
    EXPECT_THROW(read_scene(folder.path, "", unknown), Error);
}

TEST(Scene, IsCarriedByAPicture) {
    const Folder folder;
    Scene scene = parse(R"("camera": {"azimuth_deg": 77}, "transfer_function": {"preset": "gray"})");
    scene.volume = folder.path / "data" / "v.nrrd";
    Image image{1, 1, false, {1, 2, 3}};
    write_png(image, folder.path / "p.png", {{"chiaro", to_json(seen_from(scene, folder.path))}});
    std::vector<std::string> unknown;
    const Scene again = read_scene(folder.path / "p.png", "", unknown);
    EXPECT_EQ(again.volume, scene.volume);
    EXPECT_EQ(again.camera, scene.camera);
    EXPECT_EQ(again.transfer, scene.transfer);
}

TEST(Scene, ShowsNamesOfMaterialsPreClassified) {
    EXPECT_EQ(scene_of_volume("sample:cornell").sampling.classification, Classification::pre);
    EXPECT_EQ(scene_of_volume("sample:cornell:32").volume, "sample:cornell:32");
    EXPECT_EQ(scene_of_volume("sample:cornell:32").sampling.classification, Classification::pre);
    EXPECT_EQ(scene_of_volume("sample:fog").sampling.classification, Classification::post);
    EXPECT_EQ(scene_of_volume("cornell.nrrd").sampling.classification, Classification::post);
}

TEST(Scene, ChecksWhatItStatesOfTheVolume) {
    Progress progress;
    Scene scene;
    scene.volume = "sample:ball:8";
    scene.stated.dimensions = {8, 8, 8};
    scene.stated.type = VoxelType::u8;
    scene.stated.spacing_mm = Vec3{1, 2, 3};
    EXPECT_EQ(read_volume(scene, progress).geometry.spacing_mm, (Vec3{1, 2, 3}));
    scene.stated.type = VoxelType::u16;
    EXPECT_THROW(read_volume(scene, progress), Error);
    scene.stated = {{{8, 8, 9}}, {}, {}};
    EXPECT_THROW(read_volume(scene, progress), Error);
}

TEST(Scene, ChannelsAreKept) {
    const Scene scene = parse(R"("channels": [{"name": "a", "gain": 0.5},
        {"file": "b.nrrd", "show": false, "transfer_function": {"preset": "viridis"}}])");
    ASSERT_EQ(scene.channels.size(), 2u);
    EXPECT_EQ(scene.channels[0].gain, 0.5);
    EXPECT_EQ(scene.channels[1].file, "folder/b.nrrd");
    EXPECT_EQ(scene.channels[1].transfer.source, "viridis");
    EXPECT_FALSE(scene.channels[1].show);
    std::vector<std::string> unknown;
    EXPECT_EQ(parse_scene(to_json(scene), "", "", unknown).channels, scene.channels);
    EXPECT_TRUE(unknown.empty());
    EXPECT_NE(refusal(R"("channels": 3)").find("channels"), std::string::npos);
    EXPECT_NE(refusal(R"("channels": [{"gain": -1}])").find("gain -1"), std::string::npos);
    EXPECT_NE(refusal(R"("channels": [{"show": 1}])").find("show 1"), std::string::npos);
    EXPECT_NE(refusal(R"("channels": [{}, {}, {}, {}, {}, {}, {}, {}, {}])").find("at most 8"), std::string::npos);
}
