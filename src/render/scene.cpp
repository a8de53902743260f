#include <chiaro/describe.h>
#include <chiaro/error.h>
#include <chiaro/scene.h>
#include <chiaro/transfer_file.h>
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "render/scene_files.h"
#include "render/scene_keys.h"
#include "render/scene_labels.h"
#include "render/scene_marks.h"

namespace chiaro {
namespace {

constexpr int format_version = 1;

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::input, sentence); }

ReadJson parse_json(const std::string& text) {
    // Copying and printing JSON recurse: a scene is shallow, and what is not would overflow the stack.
    if (is_deeper_than(32, text)) refuse("nested too deeply");
    try {
        ReadJson json = ReadJson::parse(text);
        if (const auto twice = json_contradiction(text); !twice.empty()) refuse(twice);
        return json;
    } catch (const ReadJson::exception& error) {
        const std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 3, ..."
        refuse("not JSON: " + what.substr(std::min(what.find("] ") + 2, what.size())));
    }
}

std::string flag_text(const Setting& setting, const ReadJson& value);

/// A surface as the flag writes it.
std::string surface_text(const ReadJson& surface) {
    if (!surface.is_object() || !surface.contains("value")) refuse("iso: each surface is an object with a value");
    std::string text = surface["value"].dump();
    if (surface.contains("color")) {
        const ReadJson& color = surface["color"];
        text += "," + (color.is_string() ? color.get<std::string>() : flag_text({}, color));
    }
    if (surface.contains("opacity")) text += "@" + surface["opacity"].dump();
    return text;
}

/// Whether a list is of several lights, none included, rather than one light's own numbers.
bool are_several(const ReadJson& lights) { return lights.is_array() && (lights.empty() || !lights[0].is_number()); }

/// A value as the flag of its setting would be written.
std::string flag_text(const Setting& setting, const ReadJson& value) {
    if (setting.repeats() && (setting.scene_form != SceneForm::lights || are_several(value))) {
        if (!value.is_array()) refuse(fmt::format("{}: must be a list", setting.key));
        std::vector<std::string> items;
        for (const ReadJson& item : value)
            items.push_back(setting.scene_form == SceneForm::surfaces ? surface_text(item) : flag_text({}, item));
        return fmt::format("{}", fmt::join(items, ";"));
    }
    if (value.is_string()) return value.get<std::string>();
    if (setting.scene_form == SceneForm::on_off && value.is_boolean()) return value ? "phong" : "none";
    if (setting.scene_form == SceneForm::reciprocal && value.is_number()) return to_text(1 / value.get<double>());
    if (!value.is_array()) return value.dump();
    std::vector<std::string> items;
    for (const ReadJson& item : value) items.push_back(item.is_string() ? item.get<std::string>() : item.dump());
    return fmt::format("{}", fmt::join(items, ","));
}

Json json_of_number(double value) {
    const bool whole = value == std::floor(value) && std::abs(value) < 9e15;
    return whole ? Json(std::int64_t(value)) : Json(value);
}

Json json_of_surface(const IsoSurface& surface) {
    Json json{{"value", json_of_number(surface.value)}};
    if (surface.color) json["color"] = *surface.color;
    if (surface.opacity != 1) json["opacity"] = surface.opacity;
    return json;
}

/// The inverse of flag_text.
Json json_of(const Setting& setting, const std::string& text) {
    const bool is_one = setting.scene_form == SceneForm::lights && !text.empty() && text.find(';') == text.npos;
    if (setting.repeats() && !is_one) {
        Json list = Json::array();
        for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
            const std::size_t end = std::min(text.find(';', begin), text.size());
            const std::string item = text.substr(begin, end - begin);
            IsoSurface surface;
            if (setting.scene_form == SceneForm::surfaces) from_text(item, surface);
            list.push_back(setting.scene_form == SceneForm::surfaces ? json_of_surface(surface) : json_of({}, item));
            begin = end + 1;
        }
        return list;
    }
    if (setting.scene_form == SceneForm::on_off && text != "lambert") return text == "phong";
    if (text == "true" || text == "false") return text == "true";
    const auto numbers = numbers_in(text);
    if (numbers.empty()) return text;
    if (setting.scene_form == SceneForm::reciprocal) return json_of_number(1 / numbers[0]);
    if (numbers.size() == 1) return json_of_number(numbers[0]);
    Json list = Json::array();
    for (double number : numbers) list.push_back(json_of_number(number));
    return list;
}

/// Methods share names in a scene file: only those of the scene's own method are meant.
bool concerns(const Setting& setting, const Scene& scene) {
    return setting.concerns(to_text(scene.illumination.method));
}

void read_settings(const ReadJson& root, Scene& scene) {
    for_each_setting(
        [&](const Setting& setting, auto&... fields) {
            if (setting.scene_form == SceneForm::custom || !concerns(setting, scene)) return;
            const ReadJson* value = find(root, setting.key);
            if (!value) return;
            const std::string who = fmt::format("{} {}", setting.key, value->dump());
            set(setting, flag_text(setting, *value), who, ErrorCode::input, fields...);
        },
        scene);
}

std::string text_at(const ReadJson& root, std::string_view key) {
    const ReadJson* value = find(root, key);
    if (value && !value->is_string()) refuse(fmt::format("{} {}: must be text", key, value->dump()));
    return value ? value->get<std::string>() : "";
}

/// An object without the keys that are reported as unknown.
ReadJson only(const ReadJson& object, std::initializer_list<const char*> keys) {
    if (!object.is_object()) return object;
    ReadJson kept = ReadJson::object();
    for (const char* key : keys)
        if (object.contains(key)) kept[key] = object[key];
    return kept;
}

void read_transfer_function(const ReadJson& root, const std::filesystem::path& folder,
                            const std::filesystem::path& data_folder, TransferSettings& transfer) {
    const ReadJson* points = find(root, "transfer_function.points");
    const std::string file = text_at(root, "transfer_function.file"),
                      preset = text_at(root, "transfer_function.preset");
    if ((points != nullptr) + !file.empty() + !preset.empty() > 1)
        refuse("transfer_function: points, file and preset exclude each other");
    transfer.source = file.empty() ? preset : found_function(file, folder, data_folder);
    if (!points) return;
    ReadJson own = only(root["transfer_function"], {"points", "opacity_unit_distance", "opacity_unit_mm", "rgb_space",
                                                    "name", "gradient_opacity", "widgets"});
    if (points->is_array())
        for (ReadJson& point : own["points"]) point = only(point, {"value", "rgb", "opacity", "name"});
    transfer.points = parse_transfer_function(own.dump(), "transfer_function");
    transfer.opacity_unit.reset(), transfer.opacity_unit_mm.reset();  // these belong to the points, and replace nothing
}

std::vector<ChannelSettings> read_scene_channels(const ReadJson& root, const std::filesystem::path& folder,
                                                 const std::filesystem::path& data_folder) {
    std::vector<ChannelSettings> channels;
    const ReadJson* list = find(root, "channels");
    if (!list) return channels;
    if (!list->is_array() || list->size() > max_channels)
        refuse(fmt::format("channels: must be a list of at most {}", max_channels));
    for (const ReadJson& item : *list) {
        if (!item.is_object()) refuse("channels: each is an object");
        ChannelSettings channel;
        if (const std::string file = text_at(item, "file"); !file.empty())
            channel.file = found_file(file, folder, data_folder);
        channel.name = text_at(item, "name");
        read_transfer_function(item, folder, data_folder, channel.transfer);
        if (const ReadJson* gain = find(item, "gain")) {
            if (!gain->is_number() || !(gain->get<double>() >= 0) || !std::isfinite(gain->get<double>()))
                refuse(fmt::format("channels: gain {}: must be 0 or more", gain->dump()));
            channel.gain = gain->get<double>();
        }
        if (const ReadJson* show = find(item, "show")) {
            if (!show->is_boolean()) refuse(fmt::format("channels: show {}: must be true or false", show->dump()));
            channel.show = show->get<bool>();
        }
        channels.push_back(std::move(channel));
    }
    return channels;
}

void write_transfer_function(const TransferSettings& transfer, Json& root) {
    if (transfer.points) {
        TransferFunction tf = *transfer.points;
        if (transfer.opacity_unit) tf.opacity_unit = *transfer.opacity_unit, tf.opacity_unit_is_mm = false;
        if (transfer.opacity_unit_mm) tf.opacity_unit = *transfer.opacity_unit_mm, tf.opacity_unit_is_mm = true;
        root["transfer_function"] = Json::parse(to_json(tf));
    } else if (!transfer.source.empty()) {
        // As load_transfer_function tells the two apart; the path may be one seen from elsewhere.
        const bool named_as_file = transfer.source.find_first_of("/.") != std::string::npos;
        root["transfer_function"]
            [named_as_file || is_file(split_transfer_name(transfer.source).file) ? "file" : "preset"] = transfer.source;
    }
}

void write_channels(const std::vector<ChannelSettings>& channels, Json& root) {
    for (const ChannelSettings& channel : channels) {
        Json item = Json::object();
        if (!channel.file.empty()) item["file"] = channel.file;
        if (!channel.name.empty()) item["name"] = channel.name;
        write_transfer_function(channel.transfer, item);
        item["gain"] = json_of_number(channel.gain);
        item["show"] = channel.show;
        root["channels"].push_back(std::move(item));
    }
}

std::string read_probe(const ReadJson& root, const std::filesystem::path& folder,
                       const std::filesystem::path& data_folder) {
    const std::string file = text_at(root, "probe.file"), preset = text_at(root, "probe.preset");
    if (!file.empty() && !preset.empty()) refuse("probe: file and preset exclude each other");
    return file.empty() ? preset : found_file(file, folder, data_folder);
}

void write_probe(const std::string& source, Json& root) {
    if (!source.empty()) root["probe"][is_probe_name(source) ? "preset" : "file"] = source;
}

void check_fixed(const ReadJson& root) {
    if (!root.is_object()) refuse("must be a JSON object");
    const ReadJson* version = find(root, "chiaro");
    if (version && *version != format_version)
        refuse(fmt::format("chiaro {}: this program reads scenes of version {}", version->dump(), format_version));
    const ReadJson* model = find(root, "camera.model");
    if (model && *model != "orbit") refuse(fmt::format("camera.model {}: must be \"orbit\"", model->dump()));
}

/// Whether a camera points somewhere does not depend on the volume: any one with a frame will tell.
void check_direction(const CameraSettings& camera, ErrorCode code) {
    Geometry anywhere;
    anywhere.world = World::lps;
    try {
        make_camera(camera, anywhere, {2, 2, 2});
    } catch (const Error& error) {
        throw Error(code, error.what());
    }
}

}  // namespace

void check(const Scene& scene, ErrorCode code) {
    const auto& [source, points, window, threshold, scale, unit, unit_mm] = scene.transfer;
    if (window && window->second <= 0)
        throw Error(code, fmt::format("window {}: the width must be above 0", to_text(window)));
    if (scene.slices.window && scene.slices.window->second <= 0)
        throw Error(code, fmt::format("slices.window {}: the width must be above 0", to_text(scene.slices.window)));
    if (threshold && threshold->first > threshold->second)
        throw Error(code, fmt::format("threshold {}: LO must not be above HI", to_text(threshold)));
    if (unit && unit_mm) throw Error(code, "opacity unit: give it in voxels or in mm, not both");
    if (scene.camera.eye.has_value() != scene.camera.target.has_value())
        throw Error(code, "camera: eye and target need each other");
    if (scene.camera.fit_centre.has_value() != scene.camera.fit_radius_mm.has_value())
        throw Error(code, "camera: fit_centre and fit_radius need each other");
    if (scene.camera.aperture_mm > 0 && !is_lit(scene.mode))
        throw Error(code,
                    fmt::format("camera: --aperture has no meaning with --mode {}: a value of a whole ray has no depth",
                                to_text(scene.mode)));
    if (scene.lighting.floor.show && !is_lit(scene.mode))
        throw Error(code,
                    fmt::format("floor: --floor has no meaning with --mode {}: a value of a whole ray casts no shadow",
                                to_text(scene.mode)));
    if (!scene.labels.table.empty() && !scene.labels.any())
        throw Error(code, "labels: a table (--label-table) needs labels that it names (--labels)");
    if (!scene.labels.changes.empty() && !scene.labels.any())
        throw Error(code, "labels.changes: there are no labels that could be changed (labels.file)");
    if (scene.lighting.lights.size() > max_lights)
        throw Error(code, fmt::format("light: at most {} can shine at a time, not {}", max_lights,
                                      scene.lighting.lights.size()));
    const Method method = scene.illumination.method;
    const bool has_probe = !scene.lighting.probe.source.empty() || scene.lighting.loaded_probe;
    if (scene.lighting.probe.background && !has_probe && (method == Method::none || method == Method::spao))
        throw Error(code, "background: a probe to show is missing, such as sky or a file (.hdr, .exr)");
    check_direction(scene.camera, code);
}

Scene parse_scene(const std::string& json, const std::filesystem::path& folder,
                  const std::filesystem::path& data_folder, std::vector<std::string>& unknown_keys) {
    const ReadJson root = parse_json(json);
    check_fixed(root);
    Scene scene;
    const std::string name = text_at(root, "volume.file");
    if (name.empty()) refuse("volume.file is missing: it names the volume to show");
    scene.volume = found_file(name, folder, data_folder);
    scene.illumination.method = Method::none;  // a scene that says nothing of it was made without
    scene.interpolation = Interpolation::linear;
    // The first scene files fitted the volume, and say how far.
    if (find(root, "camera.fit_scale")) scene.camera.fit = Fit::volume;
    read_settings(root, scene);
    read_transfer_function(root, folder, data_folder, scene.transfer);
    scene.channels = read_scene_channels(root, folder, data_folder);
    scene.lighting.probe.source = read_probe(root, folder, data_folder);
    if (std::string& emission = scene.illumination.histogram.emission;
        !emission.empty() && emission.find('=') == emission.npos)
        emission = found_file(emission, folder, data_folder);
    if (!scene.labels.source.empty()) scene.labels.source = found_file(scene.labels.source, folder, data_folder);
    if (std::string& table = scene.labels.table; table.find_first_of("/.") != table.npos)
        table = found_file(table, folder, data_folder);
    scene.labels.changes = read_label_changes(root);
    scene.marks = read_marks(root);
    check(scene, ErrorCode::input);
    unknown_keys = unknown_keys_of(root);
    return scene;
}

std::string to_json(const Scene& scene) {
    Json root;
    root["chiaro"] = format_version;
    root["volume"]["file"] = scene.volume;
    write_transfer_function(scene.transfer, root);
    write_channels(scene.channels, root);
    write_probe(scene.lighting.probe.source, root);
    root["camera"]["model"] = "orbit";
    const auto write = [&](const Setting& setting, const auto&... fields) {
        const std::string text = value_text(setting, fields...);
        const bool says_nothing = text.empty() && setting.scene_form != SceneForm::lights;  // no light is said, too
        if (setting.scene_form == SceneForm::custom || says_nothing || !concerns(setting, scene)) return;
        // Names stay text, though one may look like a number: "1.10" is the UID of a series.
        const bool is_name = (std::is_same_v<decltype(fields), const std::string&> || ...);
        at(root, setting.key) = is_name ? Json(text) : json_of(setting, text);
    };
    for_each_setting(write, scene);
    if (scene.slices == SliceSettings()) root.erase("slices");
    write_label_changes(scene.labels.changes, root);
    if (scene.labels.loaded) root.erase("labels");
    write_marks(scene.marks, root);
    if (scene.read.time == 0) root["volume"].erase("time");
    if (scene.read.components_as == ComponentsAs::automatic) root["volume"].erase("channels_as");
    if (scene.read.raw == RawLayout()) root["volume"].erase("raw_endian"), root["volume"].erase("raw_offset");
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace chiaro
