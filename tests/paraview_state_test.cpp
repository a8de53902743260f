// ParaView's state files as scenes.
#include <chiaro/error.h>
#include <chiaro/scene.h>

#include "volume_files.h"

using namespace chiaro;
using volume_files::Folder;

namespace {

using Values = std::vector<std::string>;

std::string property(const std::string& name, const Values& elements, const Values& proxies = {}) {
    std::string xml = "<Property name=\"" + name + "\">";
    for (const std::string& value : elements) xml += "<Element value=\"" + value + "\"/>";
    for (const std::string& id : proxies) xml += "<Proxy value=\"" + id + "\"/>";
    return xml + "</Property>\n";
}
std::string proxy(const std::string& group, const std::string& type, const std::string& id, const std::string& inside) {
    return "<Proxy group=\"" + group + "\" type=\"" + type + "\" id=\"" + id + "\">\n" + inside + "</Proxy>\n";
}

/// A state with a volume, and an outline beside it.
struct State {
    Values files{"/gone/v.nrrd"};
    std::string as = "Volume", more, camera = property("CameraParallelProjection", {"0"});

    std::string text() const {
        const std::string view =
            property("Representations", {}, {"9", "2"}) + property("ViewSize", {"640", "480"}) +
            property("CameraPosition", {"10", "20", "300"}) + property("CameraFocalPoint", {"10", "20", "30"}) +
            property("CameraViewUp", {"0", "1", "0"}) + property("CameraViewAngle", {"25"}) +
            property("CameraParallelScale", {"40"}) + property("Background", {"0.1", "0.2", "0.3"}) + camera;
        const std::string display = property("Visibility", {"1"}) + property("Representation", {as}) +
                                    property("Input", {}, {"1"}) + property("LookupTable", {}, {"3"}) +
                                    property("ScalarOpacityFunction", {}, {"4"}) +
                                    property("ScalarOpacityUnitDistance", {"1.5"}) + property("Shade", {"0"}) + more;
        return "<?xml version=\"1.0\"?>\n<ParaView><ServerManagerState version=\"5.11.0\">\n" +
               proxy("sources", "Reader", "1", files.empty() ? "" : property("FileName", files)) +
               proxy("representations", "UniformGridRepresentation", "2", display) +
               proxy(
                   "lookup_tables", "PVLookupTable", "3",
                   property("RGBPoints", {"0", "0", "0", "0", "1", "1", "0.5", "0"}) + property("ColorSpace", {"0"})) +
               proxy("piecewise_functions", "PiecewiseFunction", "4",
                     property("Points", {"0", "0", "0.5", "0", "1", "0.8", "0.5", "0"})) +
               proxy("representations", "GeometryRepresentation", "9",
                     property("Visibility", {"1"}) + property("Representation", {"Outline"})) +
               proxy("views", "RenderView", "5", view) + "</ServerManagerState></ParaView>";
    }
};

Scene read(const std::string& text, std::vector<std::string>& notes) {
    const Folder folder;
    return read_paraview_state(folder.write("s.pvsm", text), {}, notes);
}

TEST(ParaViewState, IsAScene) {
    const Folder folder;
    folder.write("v.nrrd", "");  // moved beside the state
    const std::string file = folder.write("s.pvsm", State{}.text());
    std::vector<std::string> notes, again;
    const Scene scene = read_paraview_state(file, {}, notes);
    EXPECT_EQ(scene.volume, (folder / "v.nrrd").string());
    EXPECT_EQ(scene.width, 640);
    EXPECT_EQ(scene.height, 480);
    EXPECT_EQ(scene.camera.eye, (Vec3{10, 20, 300}));
    EXPECT_EQ(scene.camera.target, (Vec3{10, 20, 30}));
    EXPECT_EQ(scene.camera.up, (Vec3{0, 1, 0}));
    EXPECT_EQ(scene.camera.fov_deg, 25);
    EXPECT_EQ(scene.output.background, (Rgb{0.1, 0.2, 0.3}));
    EXPECT_EQ(scene.output.color, ColorMode::display);
    EXPECT_EQ(scene.illumination.method, Method::none);
    EXPECT_EQ(scene.lighting.shading, Shading::none);
    const std::vector<ControlPoint> points{{0, {0, 0, 0}, 0}, {1, {1, 0.5, 0}, 0.8}};  // not stretched over any data
    EXPECT_EQ(scene.transfer.points->points, points);
    EXPECT_EQ(scene.transfer.points->opacity_unit, 1.5);
    EXPECT_TRUE(scene.transfer.points->opacity_unit_is_mm);
    EXPECT_EQ(notes, std::vector<std::string>{"1 other shown there is left out"});
    EXPECT_EQ(to_json(read_scene(file, {}, again)), to_json(scene));
    EXPECT_EQ(again, notes);
}

TEST(ParaViewState, KeepsChiarosSettingsAndParallelRays) {
    std::vector<std::string> notes;
    const Scene scene =
        read(State{.as = "Chiaro",
                   .more = property("ChiaroLighting", {"visibility"}) + property("ChiaroShBands", {"2"}) +
                           property("ChiaroProbe", {"studio"}) + property("ChiaroFloor", {"1"}) +
                           property("ChiaroGhostLevels", {"8"}) + property("ChiaroValueOfRays", {"0"}) +
                           property("Position", {"0", "0", "5"}) + property("BlendMode", {"6"}),
                   .camera = property("CameraParallelProjection", {"1"})}
                 .text(),
             notes);
    EXPECT_EQ(scene.illumination.method, Method::visibility);
    EXPECT_EQ(scene.illumination.visibility.bands, 2);
    EXPECT_EQ(scene.lighting.probe.source, "studio");
    EXPECT_TRUE(scene.lighting.floor.show);
    EXPECT_EQ(notes.size(), 3u);  // moved, blend mode, the outline
    const Camera camera = camera_of_matrix(*scene.camera.matrix);
    EXPECT_EQ(camera.projection, Projection::orthographic);
    EXPECT_NEAR(camera.half_height, 40, 1e-9);
    EXPECT_NEAR(camera.forward.z, -1, 1e-12);
    EXPECT_NEAR(camera.up.y, 1, 1e-12);
    EXPECT_NEAR(dot(camera.eye, {1, 0, 0}), 10, 1e-9);
}

TEST(ParaViewState, RefusesWhatIsNone) {
    const auto refusal = [](const std::string& text) -> std::string {
        std::vector<std::string> notes;
        try {
            read(text, notes);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input);
            return error.what();
        }
        return "accepted";
    };
    const auto expect = [&](const std::string& text, const std::string& part) {
        EXPECT_NE(refusal(text).find(part), std::string::npos) << refusal(text);
    };
    const auto with = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    expect("", "is no XML");
    expect("<a/>", "no ServerManagerState");
    expect(State{.as = "Surface"}.text(), "shows nothing as Volume or Chiaro");
    expect(State{.files = {}}.text(), "shows what Reader makes, not a file");
    expect(with(State{}.text(), "\"25\"", "\"wide\""), "must be a number");
    expect(with(State{}.text(), "\"25\"", "\"1e9\""), "");
    expect(with(State{}.text(), "\"300\"", "\"30\""), "no position and focal point");
    expect(with(State{}.text(), "value=\"0.5\"", "value=\"7\""), "must be in");
    expect(State{.as = "Chiaro", .more = property("ChiaroLighting", {"candles"})}.text(), "candles");
}

}  // namespace
