// Transfer functions as JSON: the `transfer_function` object of a scene.
#include <chiaro/error.h>
#include <chiaro/transfer_function.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/did_you_mean.h"
#include "core/text.h"

namespace chiaro {
namespace {

using Json = nlohmann::json;
constexpr std::size_t max_points = 65536, max_file_bytes = 16 << 20;

/// A value in the file with the path that leads to it, for messages such as "tf.json: points[2].opacity ...".
struct Node {
    const Json& json;
    const std::string& origin;
    std::string path;

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::input, origin + ": " + (path.empty() ? "" : path + " ") + one_line(what));
    }
    [[noreturn]] void fail_type(const std::string& wanted) const {
        fail("is " + std::string(json.type_name()) + ": must be " + wanted);
    }
    Node at(const std::string& key) const {
        if (!json.contains(key)) fail("lacks '" + key + "'");
        return {json.at(key), origin, path.empty() ? key : path + "." + key};
    }
    Node at(std::size_t i) const { return {json.at(i), origin, path + "[" + std::to_string(i) + "]"}; }
    double number() const {
        if (!json.is_number()) fail_type("a number");
        return json.get<double>();
    }
    std::string text() const {
        if (!json.is_string()) fail_type("text");
        return json.get<std::string>();
    }
    void require_keys(const std::vector<std::string>& known) const {
        if (!json.is_object()) fail_type("an object");
        for (const auto& [key, value] : json.items())
            if (std::find(known.begin(), known.end(), key) == known.end())
                fail((path.empty() ? "" : "has ") + ("unknown key '" + key + "'") + did_you_mean(key, known));
    }
};

ControlPoint read_point(const Node& node) {
    node.require_keys({"value", "rgb", "opacity"});
    ControlPoint point;
    point.value = node.at("value").number();
    point.opacity = node.at("opacity").number();
    const Node rgb = node.at("rgb");
    if (!rgb.json.is_array()) rgb.fail_type("three numbers in [0, 1]");
    if (rgb.json.size() != 3) rgb.fail("has " + std::to_string(rgb.json.size()) + " numbers: must have 3");
    for (std::size_t c = 0; c < 3; ++c) point.rgb[c] = rgb.at(c).number();
    return point;
}

void read_unit(const Node& node, TransferFunction& tf) {
    const bool mm = node.json.contains("opacity_unit_mm"), voxels = node.json.contains("opacity_unit_distance");
    if (mm && voxels) node.fail("has both 'opacity_unit_distance' and 'opacity_unit_mm': must be one of the two");
    if (!mm && !voxels) return;
    const Node unit = node.at(mm ? "opacity_unit_mm" : "opacity_unit_distance");
    tf.opacity_unit = unit.number();
    tf.opacity_unit_is_mm = mm;
    if (!(tf.opacity_unit > 0)) unit.fail("is " + to_text(tf.opacity_unit) + ": must be greater than 0");
}

TransferFunction read_function(const Node& node) {
    node.require_keys({"points", "opacity_unit_distance", "opacity_unit_mm", "rgb_space", "name"});
    TransferFunction tf;
    const Node points = node.at("points");
    if (!points.json.is_array()) points.fail_type("an array");
    if (points.json.empty() || points.json.size() > max_points)
        points.fail("has " + std::to_string(points.json.size()) + " entries: must have 1.." +
                    std::to_string(max_points));
    for (std::size_t i = 0; i < points.json.size(); ++i) tf.points.push_back(read_point(points.at(i)));
    read_unit(node, tf);
    if (node.json.contains("rgb_space")) {
        const std::string space = node.at("rgb_space").text();
        if (space != "srgb" && space != "linear")
            node.at("rgb_space").fail("is '" + space + "': must be 'srgb' or 'linear'");
        tf.rgb_space = space == "linear" ? RgbSpace::linear : RgbSpace::srgb;
    }
    if (node.json.contains("name")) tf.name = node.at("name").text();
    return tf;
}

Json parse(const std::string& text, const std::string& origin) {
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {  // "[json.exception.parse_error.101] parse error at line 3, column 7: ..."
        const std::string what = error.what();
        throw Error(ErrorCode::input,
                    origin + ": is not JSON: " + one_line(what.substr(std::min(what.find("] ") + 2, what.size()))));
    }
}

TransferFunction function_from(const Json& json, const std::string& origin) {
    TransferFunction tf = read_function({json, origin, ""});
    try {
        validate(tf);
    } catch (const Error& error) {
        throw Error(error.code(), origin + ": " + error.what());
    }
    return tf;
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(max_file_bytes + 1, '\0');
    file.read(text.data(), std::streamsize(text.size()));
    if (file.bad() || (!file.eof() && file.fail()))
        throw Error(ErrorCode::input, "cannot read '" + path.string() + "'");
    text.resize(std::size_t(file.gcount()));
    if (text.size() > max_file_bytes)
        throw Error(ErrorCode::input, path.string() + ": is larger than 16 MiB, which no transfer function needs");
    return text;
}

}  // namespace

TransferFunction parse_transfer_function(const std::string& json, const std::string& origin) {
    return function_from(parse(json, origin), origin);
}

TransferFunction load_transfer_function(const std::string& file_or_preset, const Statistics& data) {
    std::error_code ignored;
    if (!std::filesystem::exists(file_or_preset, ignored)) {
        if (file_or_preset.find_first_of("/.") == std::string::npos) return preset(file_or_preset, data);
        throw Error(ErrorCode::input, "cannot read '" + file_or_preset + "': no such file");
    }
    const Json json = parse(read_text(file_or_preset), file_or_preset);
    if (!json.is_object() || !json.contains("preset")) return function_from(json, file_or_preset);
    const Node node{json, file_or_preset, ""};
    node.require_keys({"preset"});
    try {
        return preset(node.at("preset").text(), data);
    } catch (const Error& error) {
        node.fail(error.what());
    }
}

std::string to_json(const TransferFunction& tf) {
    nlohmann::ordered_json json;
    if (!tf.name.empty()) json["name"] = tf.name;
    json[tf.opacity_unit_is_mm ? "opacity_unit_mm" : "opacity_unit_distance"] = tf.opacity_unit;
    if (tf.rgb_space == RgbSpace::linear) json["rgb_space"] = "linear";
    json["points"] = nlohmann::ordered_json::array();
    for (const ControlPoint& point : tf.points)
        json["points"].push_back({{"value", point.value}, {"rgb", point.rgb}, {"opacity", point.opacity}});
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace chiaro
