// Presets and colour maps by name.
#include <chiaro/error.h>
#include <chiaro/samples.h>

#include <algorithm>
#include <charconv>

#include "classify/presets.h"
#include "core/color_map_opacity.h"
#include "core/did_you_mean.h"
#include "core/share.h"

namespace chiaro {
namespace {

constexpr std::string_view sample_prefix = "sample:";

/// Values 0..1 to low..high. A volume of one value gets a range of 1.
TransferFunction stretched(TransferFunction tf, double low, double high) {
    for (ControlPoint& point : tf.points)
        point.value = high > low ? at_share(low, high, point.value) : low + point.value;
    return tf;
}

TransferFunction from_row(const PresetRow& row, const Statistics& data) {
    TransferFunction tf{row.points, RgbSpace::srgb, row.opacity_unit, row.opacity_unit_is_mm, row.info.name};
    if (!row.info.stretched) {
        for (ControlPoint& point : tf.points) point.value += data.hu_zero;
        return tf;
    }
    // The last tenth of a percent is metal, pads and noise; the median of much data is background.
    const bool sparse = data.p999 <= data.p1;  // nearly all voxels have one value: all that is left is the range
    return stretched(tf, sparse ? data.min : data.p1, sparse ? data.max : data.p999);
}

double hex_component(std::string_view stop, std::size_t colon, int component) {
    unsigned value = 0;
    const char* digits = stop.data() + colon + 1 + 2 * component;
    std::from_chars(digits, digits + 2, value, 16);
    return value / 255.0;
}

std::vector<ControlPoint> parse_stops(std::string_view stops) {
    std::vector<ControlPoint> points;
    while (!stops.empty()) {
        const std::string_view stop = stops.substr(0, stops.find(' '));
        stops.remove_prefix(std::min(stops.size(), stop.size() + 1));
        const std::size_t colon = stop.find(':');
        ControlPoint point;
        std::from_chars(stop.data(), stop.data() + colon, point.value);
        for (int c = 0; c < 3; ++c) point.rgb[c] = hex_component(stop, colon, c);
        points.push_back(point);
    }
    return points;
}

/// With the opacity of ColorMapOpacity.
TransferFunction from_color_map(const ColorMapRow& row, bool reversed) {
    constexpr double start = ColorMapOpacity::start, highest = ColorMapOpacity::highest;
    TransferFunction tf;
    tf.points = parse_stops(row.stops);
    if (reversed) {
        std::reverse(tf.points.begin(), tf.points.end());
        for (ControlPoint& point : tf.points) point.value = 1 - point.value;
    }
    const auto after =
        std::find_if(tf.points.begin(), tf.points.end(), [](const ControlPoint& p) { return p.value >= start; });
    if (after->value != start) tf.points.insert(after, evaluate(tf, start));
    for (ControlPoint& point : tf.points) point.opacity = highest * std::max(0.0, (point.value - start) / (1 - start));
    tf.name = std::string(row.name) + (reversed ? "_r" : "");
    return tf;
}

}  // namespace

std::vector<PresetInfo> list_presets() {
    std::vector<PresetInfo> infos;
    for (const PresetRow& row : preset_rows()) infos.push_back(row.info);
    for (const ColorMapRow& row : color_map_rows())
        infos.push_back({std::string(row.name), "", "colour map over the data's range", true});
    return infos;
}

TransferFunction preset(const std::string& name, const Statistics& data) {
    if (name.starts_with(sample_prefix)) return sample_transfer_function(name.substr(sample_prefix.size()));
    std::vector<std::string> names;
    for (const PresetRow& row : preset_rows()) {
        if (row.info.name == preset_of_alias(name)) return from_row(row, data);
        names.push_back(row.info.name);
    }
    const bool reversed = name.ends_with("_r");
    const std::string_view map = std::string_view(name).substr(0, name.size() - (reversed ? 2 : 0));
    for (const ColorMapRow& row : color_map_rows()) {
        if (row.name == map) return stretched(from_color_map(row, reversed), data.min, data.max);
        names.push_back(std::string(row.name) + (reversed ? "_r" : ""));
    }
    const std::string hint = did_you_mean(name, names);
    throw Error(ErrorCode::usage,
                "unknown transfer function '" + name + "'" +
                    (hint.empty() ? ": must be a file, preset or colour map (--list-presets)" : hint));
}

}  // namespace chiaro
