// Transfer functions as JSON: the `transfer_function` object of a scene.
#include <chiaro/error.h>
#include <chiaro/transfer_function.h>

#include "core/text.h"
#include "io/transfer/json_node.h"
#include "io/transfer/reader.h"

namespace chiaro {
namespace {

constexpr const char* widget_shapes[] = {"rectangle", "ellipse", "triangle"};

ControlPoint read_point(const JsonNode& node) {
    node.require_keys({"value", "rgb", "opacity", "name"});
    ControlPoint point;
    point.value = node.at("value").number();
    point.opacity = node.at("opacity").number();
    const JsonNode rgb = node.at("rgb");
    if (!rgb.json.is_array()) rgb.fail_type("three numbers in [0, 1]");
    if (rgb.json.size() != 3) rgb.fail("has " + std::to_string(rgb.json.size()) + " numbers: must have 3");
    for (std::size_t c = 0; c < 3; ++c) point.rgb[c] = rgb.at(c).number();
    if (node.json.contains("name")) point.name = node.at("name").text();
    return point;
}

void read_unit(const JsonNode& node, TransferFunction& tf) {
    const bool mm = node.json.contains("opacity_unit_mm"), voxels = node.json.contains("opacity_unit_distance");
    if (mm && voxels) node.fail("has both 'opacity_unit_distance' and 'opacity_unit_mm': must be one of the two");
    if (!mm && !voxels) return;
    const JsonNode unit = node.at(mm ? "opacity_unit_mm" : "opacity_unit_distance");
    tf.opacity_unit = unit.number();
    tf.opacity_unit_is_mm = mm;
    if (!(tf.opacity_unit > 0)) unit.fail("is " + to_text(tf.opacity_unit) + ": must be greater than 0");
}

template <class Item, class Read>
std::vector<Item> read_list(const JsonNode& node, const char* key, const Read& read) {
    std::vector<Item> items;
    if (!node.json.contains(key)) return items;
    const JsonNode list = node.at(key);
    if (!list.json.is_array()) list.fail_type("an array");
    if (list.json.size() > max_transfer_points)
        list.fail("has " + std::to_string(list.json.size()) + " entries: must have at most " +
                  std::to_string(max_transfer_points));
    for (std::size_t i = 0; i < list.json.size(); ++i) items.push_back(read(list.at(i)));
    return items;
}

GradientPoint read_gradient_point(const JsonNode& node) {
    node.require_keys({"magnitude", "opacity"});
    return {node.at("magnitude").number(), node.at("opacity").number()};
}

GradientWidget read_widget(const JsonNode& node) {
    node.require_keys({"shape", "value", "magnitude", "opacity"});
    GradientWidget widget;
    const std::string shape = node.at("shape").text();
    const auto known = std::find(std::begin(widget_shapes), std::end(widget_shapes), shape);
    if (known == std::end(widget_shapes))
        node.at("shape").fail("is '" + shape + "': must be 'rectangle', 'ellipse' or 'triangle'");
    widget.shape = WidgetShape(known - std::begin(widget_shapes));
    const auto range = [&](const char* key, double& low, double& high) {
        const JsonNode both = node.at(key);
        if (!both.json.is_array() || both.json.size() != 2) both.fail("must be two numbers, the lower one first");
        low = both.at(std::size_t(0)).number(), high = both.at(std::size_t(1)).number();
    };
    range("value", widget.value_low, widget.value_high);
    range("magnitude", widget.magnitude_low, widget.magnitude_high);
    if (node.json.contains("opacity")) widget.opacity = node.at("opacity").number();
    return widget;
}

TransferFunction read_function(const JsonNode& node) {
    node.require_keys(
        {"points", "opacity_unit_distance", "opacity_unit_mm", "rgb_space", "name", "gradient_opacity", "widgets"});
    TransferFunction tf;
    const JsonNode points = node.at("points");
    if (!points.json.is_array()) points.fail_type("an array");
    if (points.json.empty() || points.json.size() > max_transfer_points)
        points.fail("has " + std::to_string(points.json.size()) + " entries: must have 1.." +
                    std::to_string(max_transfer_points));
    for (std::size_t i = 0; i < points.json.size(); ++i) tf.points.push_back(read_point(points.at(i)));
    tf.gradient = read_list<GradientPoint>(node, "gradient_opacity", read_gradient_point);
    tf.widgets = read_list<GradientWidget>(node, "widgets", read_widget);
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
        Json json = Json::parse(text);
        if (const auto twice = json_contradiction(text); !twice.empty())
            throw Error(ErrorCode::input, origin + ": " + twice);
        return json;
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::input, origin + ": " + json_trouble(error));
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

}  // namespace

TransferFunction parse_transfer_function(const std::string& json, const std::string& origin) {
    return function_from(parse(json, origin), origin);
}

FoundFunction read_own(const TransferText& text, const Statistics& data) {
    FoundFunction found;
    if (text.json && text.json->is_object() && text.json->contains("preset")) {
        const JsonNode node{*text.json, text.name, ""};
        node.require_keys({"preset"});
        try {
            found.function = preset(node.at("preset").text(), data);
        } catch (const Error& error) {  // here it is the file's fault
            node.fail(error.what());
        }
    } else {
        found.function = parse_transfer_function(text.text, text.name);  // which forgives nothing
    }
    return found;
}

std::string to_json(const TransferFunction& tf) {
    nlohmann::ordered_json json;
    if (!tf.name.empty()) json["name"] = tf.name;
    json[tf.opacity_unit_is_mm ? "opacity_unit_mm" : "opacity_unit_distance"] = tf.opacity_unit;
    if (tf.rgb_space == RgbSpace::linear) json["rgb_space"] = "linear";
    const auto text_of = [](const nlohmann::ordered_json& part, int indent) {
        return part.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    };
    for (const GradientPoint& point : tf.gradient)
        json["gradient_opacity"].push_back({{"magnitude", point.magnitude}, {"opacity", point.opacity}});
    for (const GradientWidget& widget : tf.widgets)
        json["widgets"].push_back({{"shape", widget_shapes[int(widget.shape)]},
                                   {"value", {widget.value_low, widget.value_high}},
                                   {"magnitude", {widget.magnitude_low, widget.magnitude_high}},
                                   {"opacity", widget.opacity}});
    std::string points;  // a line each
    for (const ControlPoint& point : tf.points) {
        nlohmann::ordered_json one{{"value", point.value}, {"rgb", point.rgb}, {"opacity", point.opacity}};
        if (!point.name.empty()) one["name"] = point.name;
        points += (points.empty() ? "\n    " : ",\n    ") + text_of(one, -1);
    }
    std::string text = text_of(json, 2);
    text.resize(text.size() - 2);  // "\n}"
    return text + ",\n  \"points\": [" + points + "\n  ]\n}";
}

}  // namespace chiaro
