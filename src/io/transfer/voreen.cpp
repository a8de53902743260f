// Voreen's .tfi: XML with keys over a domain. Intensities are shares of the domain, colours 0 to 255; a split key has
// one colour to its left and another to its right. Outside the thresholds, shares too, all is transparent. A gamma
// other than 1 bends the axis: what is seen at the share t is the keys' colour at t^gamma. Voreen's alpha belongs to
// 1/200 of the volume's edge; as it depends on the volume, it is left to --opacity-unit.
#include <cmath>
#include <limits>
#include <optional>

#include "io/transfer/curve.h"
#include "io/transfer/xml_node.h"

namespace chiaro {
namespace {

using Node = CurveNode<4>;
enum AlphaMode { transparent = 0, as_stated = 1, opaque = 2 };

struct Key {
    double intensity;
    std::array<double, 4> left, right;
};

std::array<double, 4> read_color(const XmlNode& node) {
    std::array<double, 4> rgba;
    const char* names[] = {"r", "g", "b", "a"};
    for (int c = 0; c < 4; ++c) rgba[c] = node.number_in(names[c], 0, 255) / 255;
    return rgba;
}

Key read_key(const XmlNode& node) {
    Key key{node.child("intensity").number_in("value", 0, 1), read_color(node.child("colorL")), {}};
    const XmlNode split = node.child("split");
    const std::string value = split.node.attribute("value").value();
    if (value != "true" && value != "false")
        split.fail(fmt::format("value is '{}': must be true or false", printable(value)));
    key.right = value == "true" ? read_color(node.child("colorR")) : key.left;
    return key;
}

std::vector<Key> read_keys(const XmlNode& list) {
    std::vector<Key> keys;
    for (const pugi::xml_node child : list.node.children()) {
        if (child.type() != pugi::node_element) continue;
        const XmlNode node{child, list.text};
        if (std::string(child.name()) != "key") node.fail("is no key of the function");
        if (keys.size() == max_transfer_points) list.fail(fmt::format("has more than {} keys", keys.size()));
        keys.push_back(read_key(node));
    }
    if (keys.empty()) list.fail("has no keys: must have at least one");
    std::stable_sort(keys.begin(), keys.end(), [](auto& a, auto& b) { return a.intensity < b.intensity; });
    return keys;
}

/// Keys as a curve over shares of the domain. With a gamma the line from one key to the next is bent: in u = t^gamma it
/// is straight.
Curve<4> curve_of(const XmlNode& list, const std::vector<Key>& keys, double gamma) {
    const auto share = [&](double intensity) { return gamma == 1 ? intensity : std::pow(intensity, 1 / gamma); };
    Curve<4> curve;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const Key& key = keys[i];
        const Node node{share(key.intensity), key.left};
        if (i == 0 || gamma == 1 || !(node.x > curve.back().x)) {
            curve.push_back(node);
        } else {
            const Key& from = keys[i - 1];
            const double t0 = curve.back().x, span = key.intensity - from.intensity;
            append_bent<4>(curve, node, {}, [&](double s) {
                const double u = std::pow(t0 + s * (node.x - t0), gamma);
                const double t = std::clamp((u - from.intensity) / span, 0.0, 1.0);
                std::array<double, 4> y;
                for (int c = 0; c < 4; ++c) y[c] = std::lerp(from.right[c], key.left[c], t);
                return y;
            });
        }
        if (key.right != key.left) curve.push_back({node.x, key.right});
        if (curve.size() > max_transfer_points)
            list.fail(fmt::format("needs more than {} points", max_transfer_points));
    }
    return curve;
}

double gamma_of(const XmlNode& function) {
    const pugi::xml_node node = function.any_child({"gammaValue", "gamma"});
    return node ? XmlNode{node, function.text}.number_in("value", 0.01, 100) : 1;
}

AlphaMode alpha_mode(const XmlNode& function) {
    const pugi::xml_node node = function.node.child("alphaMode");
    if (!node) return as_stated;
    const double mode = XmlNode{node, function.text}.number("value");
    if (mode != 0 && mode != 1 && mode != 2)
        XmlNode{node, function.text}.fail(fmt::format("value is {}: must be 0, 1 or 2", mode));
    return AlphaMode(int(mode));
}

/// <threshold x y>, or <lower value> and <upper value> in older files.
void apply_thresholds(const XmlNode& function, std::vector<ControlPoint>& points) {
    double low = 0, high = 1;
    if (const pugi::xml_node node = function.node.child("threshold")) {
        low = XmlNode{node, function.text}.number_in("x", 0, 1);
        high = XmlNode{node, function.text}.number_in("y", 0, 1);
    }
    if (const pugi::xml_node node = function.node.child("lower"))
        low = XmlNode{node, function.text}.number_in("value", 0, 1);
    if (const pugi::xml_node node = function.node.child("upper"))
        high = XmlNode{node, function.text}.number_in("value", 0, 1);
    if (!(low < high)) function.fail(fmt::format("has thresholds from {} to {}: must rise", low, high));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    mask(points, low > 0 ? low : -infinity, high < 1 ? high : infinity);
}

/// Where a share of the domain lies, in data units. Nothing where the file states no domain, or 0 to 1, which is what
/// Voreen writes when nobody set one.
std::optional<std::pair<double, double>> domain_of(const XmlNode& function) {
    const pugi::xml_node node = function.node.child("domain");
    if (!node) return std::nullopt;
    const XmlNode domain{node, function.text};
    const double low = domain.position_at("x"), high = domain.position_at("y");
    if (!(low < high)) domain.fail(fmt::format("is {} to {}: must rise", low, high));
    return low == 0 && high == 1 ? std::nullopt : std::optional(std::pair(low, high));
}

pugi::xml_node function_in(const XmlNode& root) {
    for (const pugi::xml_node child : root.node.children())
        if (child.child("Keys")) return child;
    root.fail("holds no one-dimensional function of keys");
}

}  // namespace

FoundFunction read_voreen(const TransferText& text, const Statistics&) {
    const XmlNode root = xml_root(text, {"VoreenData"});
    const XmlNode function{function_in(root), text}, list = function.child("Keys");
    const AlphaMode alpha = alpha_mode(function);
    FoundFunction found;
    auto& points = found.function.points;
    for (const Node& node : curve_of(list, read_keys(list), gamma_of(function)))
        points.push_back({node.x,
                          {node.y[0], node.y[1], node.y[2]},
                          alpha == as_stated ? node.y[3]
                          : alpha == opaque  ? 1.0
                                             : 0.0});
    apply_thresholds(function, points);
    span_domain(points, 0, 1);
    if (alpha != as_stated)
        found.notes.push_back(alpha == opaque ? "its alpha mode makes all values opaque"
                                              : "its alpha mode makes all values transparent");
    if (const auto domain = domain_of(function)) {
        for (ControlPoint& p : points) p.value = std::lerp(domain->first, domain->second, p.value);
    } else {
        found.relative = true;
        found.notes.push_back("its domain is 0 to 1, stretched over the data's range");
    }
    return found;
}

}  // namespace chiaro
