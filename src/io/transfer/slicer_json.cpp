// 3D Slicer's .vp.json: volumeProperties, each with components, of which the first is taken. Functions are lists of
// points with VTK's midpoint and sharpness; values in data units; opacity belongs to scalarOpacityUnitDistance (mm).
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "io/transfer/json_node.h"
#include "io/transfer/slicer.h"

namespace chiaro {
namespace {

double number_or(const JsonNode& node, const char* key, double otherwise) {
    return node.has(key) ? node.at(key).number() : otherwise;
}

double unit_number_or(const TransferText& text, const JsonNode& node, const char* key, double otherwise) {
    return node.has(key) ? in_range(text, node.path + "." + key, node.at(key).number(), 0, 1) : otherwise;
}

template <std::size_t N>
struct BentNode {
    CurveNode<N> node;
    Bend bend;  ///< of the piece behind it
};

template <std::size_t N>
BentNode<N> read_point(const TransferText& text, const JsonNode& point) {
    point.require_object();
    BentNode<N> read{{position(text, point.path + ".x", point.at("x").number()), {}}, {}};
    read.bend = {unit_number_or(text, point, "midpoint", 0.5), unit_number_or(text, point, "sharpness", 0)};
    const JsonNode value = point.at(N == 1 ? "y" : "color");
    if (N > 1 && (!value.json.is_array() || value.json.size() != N)) value.fail("must be three numbers in [0, 1]");
    for (std::size_t c = 0; c < N; ++c) {
        const JsonNode number = N == 1 ? value : value.at(c);
        read.node.y[c] = in_range(text, number.path, number.number(), 0, 1);
    }
    return read;
}

template <std::size_t N>
Curve<N> read_curve(const TransferText& text, const JsonNode& function) {
    function.require_object();
    const JsonNode list = function.at("points");
    if (!list.json.is_array()) list.fail_type("an array");
    if (list.json.empty() || list.json.size() > max_transfer_points)
        list.fail(fmt::format("has {} entries: must have 1..{}", list.json.size(), max_transfer_points));
    std::vector<BentNode<N>> nodes;
    for (std::size_t i = 0; i < list.json.size(); ++i) nodes.push_back(read_point<N>(text, list.at(i)));
    std::stable_sort(nodes.begin(), nodes.end(), [](auto& a, auto& b) { return a.node.x < b.node.x; });
    Curve<N> curve{nodes[0].node};
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        const auto from = nodes[i - 1].node.y, to = nodes[i].node.y;
        append_bent<N>(curve, nodes[i].node, nodes[i - 1].bend, [&](double s) {
            std::array<double, N> y;
            for (std::size_t c = 0; c < N; ++c) y[c] = std::lerp(from[c], to[c], s);
            return y;
        });
        if (curve.size() > max_transfer_points)
            list.fail(fmt::format("needs more than {} points", max_transfer_points));
    }
    return curve;
}

JsonNode chosen_property(const TransferText& text, const JsonNode& root, FoundFunction& found) {
    root.require_object();
    const JsonNode list = root.at("volumeProperties");
    if (!list.json.is_array() || list.json.empty()) list.fail("must be an array of at least one object");
    if (list.json.size() == 1) return list.at(std::size_t(0));
    for (std::size_t i = 1; i <= list.json.size(); ++i) found.functions.push_back(std::to_string(i));
    const std::size_t chosen = chosen_function(text, found.functions);
    if (text.choice.empty())
        found.notes.push_back(
            fmt::format("holds {} volume properties: took the first; FILE#2 takes another", list.json.size()));
    return list.at(chosen);
}

void add_notes(const TransferText& text, const JsonNode& component, std::size_t components, FoundFunction& found) {
    if (components > 1) found.notes.push_back(fmt::format("took the first of its {} components", components));
    if (component.has("lighting") && (!component.has("shade") || component.at("shade").flag())) {
        const JsonNode light = component.at("lighting");
        light.require_object();
        found.notes.push_back(
            note_on_shading({number_or(light, "ambient", 0.1), number_or(light, "diffuse", 0.7),
                             number_or(light, "specular", 0.2), number_or(light, "specularPower", 10)}));
    }
    const bool off = component.has("disableGradientOpacity") && component.at("disableGradientOpacity").flag();
    if (component.has("gradientOpacity") && !off)
        take_gradient_opacity(read_curve<1>(text, component.at("gradientOpacity")), found);
}

}  // namespace

FoundFunction read_slicer_json(const TransferText& text, const Statistics&) {
    if (!text.json) text.fail(text.trouble);
    FoundFunction choice;
    const JsonNode property = chosen_property(text, {*text.json, text.name, ""}, choice);
    property.require_object();
    const JsonNode list = property.at("components");
    if (!list.json.is_array() || list.json.empty()) list.fail("must be an array of at least one object");
    const JsonNode component = list.at(std::size_t(0));
    component.require_object();
    const double unit = number_or(component, "scalarOpacityUnitDistance", 1);
    if (!(unit > 0)) component.fail("scalarOpacityUnitDistance is " + to_text(unit) + ": must be greater than 0");
    const ColorCurve color = read_curve<3>(text, component.at("rgbTransferFunction"));
    FoundFunction found = slicer_function(color, read_curve<1>(text, component.at("scalarOpacity")), unit);
    found.functions = std::move(choice.functions);
    found.notes = std::move(choice.notes);
    add_notes(text, component, list.json.size(), found);
    return found;
}

}  // namespace chiaro
