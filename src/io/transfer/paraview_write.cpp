// Colour maps for ParaView.
#include <chiaro/transfer_file.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/srgb.h"
#include "io/transfer/curve.h"

namespace chiaro {
namespace {

/// Linear colours as sRGB: the straight lines between them become bent ones, and are sampled.
ColorCurve as_srgb(const std::vector<ControlPoint>& points) {
    const auto srgb = [](const Rgb& c) {
        return Rgb{srgb_from_linear(c[0]), srgb_from_linear(c[1]), srgb_from_linear(c[2])};
    };
    ColorCurve curve{{points[0].value, srgb(points[0].rgb)}};
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Rgb from = points[i - 1].rgb, to = points[i].rgb;
        const CurveNode<3> node{points[i].value, srgb(to)};
        if (node.x == curve.back().x) {
            curve.push_back(node);
        } else {
            append_bent<3>(curve, node, {}, [&](double s) {
                return srgb({std::lerp(from[0], to[0], s), std::lerp(from[1], to[1], s), std::lerp(from[2], to[2], s)});
            });
        }
    }
    return curve;
}

}  // namespace

std::string to_paraview_json(const TransferFunction& tf) {
    nlohmann::ordered_json map;
    map["Name"] = tf.name.empty() ? "Chiaro" : tf.name;
    map["ColorSpace"] = "RGB";
    auto& colors = map["RGBPoints"] = nlohmann::ordered_json::array();
    auto& opacities = map["Points"] = nlohmann::ordered_json::array();
    const bool linear = tf.rgb_space == RgbSpace::linear;
    ColorCurve curve;
    if (linear)
        curve = as_srgb(tf.points);
    else
        for (const ControlPoint& p : tf.points) curve.push_back({p.value, p.rgb});
    for (const auto& [x, rgb] : curve)
        for (double number : {x, rgb[0], rgb[1], rgb[2]}) colors.push_back(number);
    for (const ControlPoint& p : tf.points)
        for (double number : {p.value, p.opacity, 0.5, 0.0}) opacities.push_back(number);
    map["Chiaro"][tf.opacity_unit_is_mm ? "opacity_unit_mm" : "opacity_unit_distance"] = tf.opacity_unit;
    return nlohmann::ordered_json::array({map}).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace chiaro
