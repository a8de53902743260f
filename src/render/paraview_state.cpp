// ParaView's state files (.pvsm): XML of proxies, each a list of properties.
#include "io/transfer/reader.h"
#include "io/xml_attributes.h"
#include "render/scene_files.h"

#include <chiaro/describe.h>
#include <chiaro/error.h>
#include <chiaro/scene.h>
#include <chiaro/transfer_file.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/file_contents.h"
#include "core/text.h"

namespace chiaro {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t max_state_bytes = 64u << 20;

[[noreturn]] void refuse_state(const std::string& sentence) { throw Error(ErrorCode::input, sentence); }

/// One of the state's objects.
struct Proxy {
    pugi::xml_node node;

    explicit operator bool() const { return bool(node); }
    std::string type() const { return one_line(node.attribute("type").as_string(), 60); }
    std::vector<std::string> texts(const std::string& property) const {
        std::vector<std::string> values;
        const auto found = node.find_child_by_attribute("Property", "name", property.c_str());
        for (const auto& element : found.children("Element")) values.push_back(element.attribute("value").as_string());
        return values;
    }
    std::string text(const std::string& property) const {
        const auto all = texts(property);
        return all.empty() ? "" : all[0];
    }
    /// As many as there are; throws where one is no finite number.
    std::vector<double> numbers(const std::string& property) const {
        std::vector<double> values;
        for (const std::string& text : texts(property))
            if (!parse_number(text, values.emplace_back()) || !std::isfinite(values.back()))
                refuse_state(fmt::format("{} is '{}': must be a number", property, one_line(text, 40)));
        return values;
    }
    double number(const std::string& property, double otherwise) const {
        const auto all = numbers(property);
        return all.empty() ? otherwise : all[0];
    }
    std::optional<Vec3> vector(const std::string& property) const {
        const auto all = numbers(property);
        return all.size() == 3 ? std::optional(Vec3{all[0], all[1], all[2]}) : std::nullopt;
    }
    /// Numbers of the objects that a property names.
    std::vector<std::string> proxies(const std::string& property) const {
        std::vector<std::string> ids;
        const auto found = node.find_child_by_attribute("Property", "name", property.c_str());
        for (const auto& proxy : found.children("Proxy")) ids.push_back(proxy.attribute("value").as_string());
        return ids;
    }
};

class State {
public:
    explicit State(const std::string& text) {
        const auto result = document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
        if (!result) refuse_state(fmt::format("is no XML: {}", result.description()));
        if (const auto twice = attribute_stated_twice(document_); !twice.empty())
            refuse_state("states " + twice + " twice");
        const auto outer = document_.document_element();
        state_ = std::string_view(outer.name()) == "ServerManagerState" ? outer : outer.child("ServerManagerState");
        if (!state_) refuse_state("is no state of ParaView: it has no ServerManagerState");
    }
    Proxy proxy(const std::string& id) const { return {state_.find_child_by_attribute("Proxy", "id", id.c_str())}; }
    Proxy named(const Proxy& from, const std::string& property) const {
        const auto ids = from.proxies(property);
        return ids.empty() ? Proxy{} : proxy(ids[0]);
    }
    /// The first view that shows a volume, and that volume; in how many things are shown beside it.
    struct Shown {
        Proxy view, display;
        int others = 0;
    };
    Shown shown() const {
        for (const auto& node : state_.children("Proxy")) {
            const Proxy view{node};
            if (std::string_view(node.attribute("group").as_string()) != "views") continue;
            Shown found{view, {}, 0};
            for (const std::string& id : view.proxies("Representations")) {
                const Proxy display = proxy(id);
                if (!display || display.text("Visibility") != "1") continue;
                const std::string as = display.text("Representation");
                if (!found.display && (as == "Volume" || as == "Chiaro"))
                    found.display = display;
                else
                    ++found.others;
            }
            if (found.display) return found;
        }
        refuse_state("shows nothing as Volume or Chiaro");
    }

private:
    pugi::xml_document document_;
    pugi::xml_node state_;
};

std::string volume_of(const State& state, const Proxy& display, const fs::path& folder, const fs::path& data,
                      std::vector<std::string>& notes) {
    const Proxy source = state.named(display, "Input");
    if (!source) refuse_state("has a volume without a source");
    auto files = source.texts("FileName");
    if (files.empty()) files = source.texts("FileNames");
    if (files.empty())
        refuse_state(fmt::format("shows what {} makes, not a file: save that as a file, and its state", source.type()));
    if (files.size() > 1)
        notes.push_back(fmt::format("of its {} files the first is shown: {}", files.size(), one_line(files[0], 200)));
    const std::string file = found_file(files[0], folder, data);
    if (is_file(file)) return file;
    return found_file(fs::path(files[0]).filename().string(), folder, data);  // on another machine
}

/// As a colour map's file, which is read as any other.
TransferFunction transfer_of(const State& state, const Proxy& display, std::vector<std::string>& notes) {
    const Proxy colours = state.named(display, "LookupTable"), opacity = state.named(display, "ScalarOpacityFunction");
    if (!colours) refuse_state("has a volume without a colour map");
    constexpr const char* spaces[] = {"RGB", "HSV", "Lab", "Diverging", "Lab/CIEDE2000", "Step"};
    const double space = colours.number("ColorSpace", 0);
    nlohmann::json map{{"Name", "state"},
                       {"RGBPoints", colours.numbers("RGBPoints")},
                       {"Chiaro", {{"opacity_unit_mm", display.number("ScalarOpacityUnitDistance", 1)}}}};
    if (space >= 0 && space < 6) map["ColorSpace"] = spaces[int(space)];
    if (opacity) map["Points"] = opacity.numbers("Points");
    for (const char* flag : {"HSVWrap", "UseBelowRangeColor", "UseAboveRangeColor", "UseLogScale"})
        map[flag] = colours.text(flag) == "1";
    TransferFile file = parse_transfer_file(map.dump(), "its colour map.json", Statistics());
    notes.insert(notes.end(), file.notes.begin(), file.notes.end());
    file.function.name.clear();
    return file.function;
}

/// Of parallel rays, which begin before all that is: x right, y up, z away from the viewer, in shares of the view.
Matrix4 parallel_matrix(Vec3 eye, Vec3 target, Vec3 up, double half_height, double half_width) {
    constexpr double reach = 1e3;  // of half heights, before and behind the target
    const Vec3 ahead = normalized(target - eye), right = normalized(cross(ahead, up)), above = cross(right, ahead);
    Matrix4 m{};
    const auto row = [&](std::size_t r, Vec3 axis, double scale) {
        for (int c = 0; c < 3; ++c) m[4 * r + std::size_t(c)] = axis[c] / scale;
        m[4 * r + 3] = -dot(axis, target) / scale;
    };
    row(0, right, half_width), row(1, above, half_height), row(2, ahead, reach * half_height);
    m[15] = 1;
    return m;
}

void set_camera(const Proxy& view, Scene& scene) {
    const auto size = view.numbers("ViewSize");
    if (size.size() == 2 && size[0] >= 1 && size[1] >= 1 && size[0] <= 16384 && size[1] <= 16384)
        scene.width = int(size[0]), scene.height = int(size[1]);
    const auto eye = view.vector("CameraPosition"), target = view.vector("CameraFocalPoint"),
               up = view.vector("CameraViewUp");
    if (!eye || !target || *eye == *target) refuse_state("has a view whose camera has no position and focal point");
    if (view.text("CameraParallelProjection") == "1") {
        const double half = view.number("CameraParallelScale", 1);
        if (!(half > 0) || length(cross(*target - *eye, up.value_or(Vec3{0, 1, 0}))) == 0)
            refuse_state("has a view whose camera sees nothing");
        scene.camera.matrix =
            parallel_matrix(*eye, *target, up.value_or(Vec3{0, 1, 0}), half, half * scene.width / scene.height);
        return;
    }
    scene.camera.eye = eye, scene.camera.target = target, scene.camera.up = up;
    scene.camera.fov_deg = view.number("CameraViewAngle", 30);
}

/// "sh-bands", "ChiaroShBands": "shbands".
std::string plain_name(std::string_view name) {
    std::string plain;
    for (const char c : name)
        if (c != '-') plain += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return plain;
}

/// Those that the panel of the representation Chiaro has.
void set_own_settings(const Proxy& display, Scene& scene) {
    std::map<std::string, std::string> stated;
    for (const auto& property : display.node.children("Property")) {
        const std::string_view name = property.attribute("name").as_string();
        if (!name.starts_with("Chiaro")) continue;
        const std::string value = display.text(std::string(name));
        if (!value.empty()) stated[plain_name(name.substr(6))] = value;
    }
    GivenSettings given;
    for_each_setting(
        [&](const Setting& setting, const auto& field, const auto&...) {
            const auto found = stated.find(plain_name(setting.name));
            if (setting.name.empty() || found == stated.end()) return;
            const bool is_flag = std::is_same_v<std::remove_cvref_t<decltype(field)>, bool>;
            given[std::string(setting.name)] = !is_flag ? found->second : found->second == "1" ? "true" : "false";
        },
        scene);
    set_by_name(scene, given, [](auto name, auto value) { return fmt::format("{} {}", name, value); });
    constexpr Mode modes[] = {Mode::dvr, Mode::mip, Mode::minip, Mode::mean, Mode::additive};
    if (const double mode = display.number("ChiaroValueOfRays", 0); mode >= 1 && mode <= 4)
        scene.mode = modes[int(mode)];
}

void set_look(const Proxy& view, const Proxy& display, Scene& scene, std::vector<std::string>& notes) {
    Lighting& lighting = scene.lighting;
    lighting.shading = display.text("Shade") == "1" ? Shading::phong : Shading::none;
    const auto share = [&](const char* name, double otherwise) {
        return std::clamp(display.number(name, otherwise), 0.0, 1.0);
    };
    lighting.ambient = share("Ambient", 0), lighting.diffuse = share("Diffuse", 1);
    lighting.specular = share("Specular", 0);
    lighting.shininess = std::clamp(display.number("SpecularPower", 20), 1.0, 128.0);
    scene.output.color = ColorMode::display;
    if (const auto rgb = view.vector("Background"))
        for (int c = 0; c < 3; ++c) scene.output.background[std::size_t(c)] = std::clamp((*rgb)[c], 0.0, 1.0);
    scene.illumination = {.method = Method::none};
    scene.interpolation = Interpolation::linear;
    if (display.text("Representation") == "Chiaro") set_own_settings(display, scene);
    if (lighting.shading == Shading::phong && lighting.probe.source.empty())
        notes.push_back("its lights are left out: one shines from the eye");
    if (const double mode = display.number("BlendMode", 0); mode != 0)
        notes.push_back(fmt::format("its blend mode {} is left out: it is composited", mode));
    const auto is = [&](const char* name, Vec3 wanted) { return display.vector(name).value_or(wanted) == wanted; };
    if (!is("Position", {0, 0, 0}) || !is("Orientation", {0, 0, 0}) || !is("Scale", {1, 1, 1}))
        notes.push_back("the volume is shown where its file has it: that it was moved, turned or scaled is left out");
}

}  // namespace

Scene read_paraview_state(const fs::path& file, const fs::path& data_folder, std::vector<std::string>& notes) {
    const std::string text = file_text(file, max_state_bytes);
    try {
        const State state(text);
        const auto [view, display, others] = state.shown();
        Scene scene;
        scene.volume = volume_of(state, display, file.parent_path(), data_folder, notes);
        scene.transfer.points = transfer_of(state, display, notes);
        set_camera(view, scene);
        set_look(view, display, scene, notes);
        if (others > 0)
            notes.push_back(fmt::format("{} other{} shown there {} left out", others, others > 1 ? "s" : "",
                                        others > 1 ? "are" : "is"));
        check(scene, ErrorCode::input);
        return scene;
    } catch (const Error& error) {
        throw Error(ErrorCode::input, fmt::format("{}: {}", file.string(), one_line(error.what(), 1000)));
    }
}

}  // namespace chiaro
