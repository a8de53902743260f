// The data behind `preset`: tables only.
#pragma once
#include <chiaro/transfer_function.h>

#include <span>
#include <string_view>

namespace chiaro {

/// A row of presets.cpp. Values are HU, or shares of the data's range when stretched (see `preset`).
struct PresetRow {
    PresetInfo info;
    double opacity_unit;
    bool opacity_unit_is_mm;
    std::vector<ControlPoint> points;
};
std::span<const PresetRow> preset_rows();

/// Names of 3D Slicer's presets that are served by one of ours under another name; any other name as it is.
std::string_view preset_of_alias(std::string_view name);

/// A colour map: sRGB colours at positions in [0, 1], linear between.
struct ColorMapRow {
    std::string_view name;
    std::string_view stops;  ///< "0:440154 0.25:3a528b ... 1:fde725"
};
std::span<const ColorMapRow> color_map_rows();

}  // namespace chiaro
