// What a value looks like: colour and opacity.
#pragma once
#include <chiaro/export.h>
#include <chiaro/volume.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace chiaro {

using Rgb = std::array<double, 3>;

struct ControlPoint {
    double value = 0;    ///< in data units (HU for CT)
    Rgb rgb{0, 0, 0};    ///< [0, 1], in the function's rgb_space
    double opacity = 0;  ///< [0, 1] per opacity unit distance
    std::string name{};  ///< what people call the matter that begins here ("Leaves"); kept, never looked at
    bool operator==(const ControlPoint&) const = default;
};

/// Opacity by gradient: a factor of the extinction over the magnitude of the values' gradient.
struct GradientPoint {
    double magnitude = 0;  ///< >= 0, data units per mm, by the differences that shade
    double opacity = 1;    ///< [0, 1]
    bool operator==(const GradientPoint&) const = default;
};

/// A shape over value and magnitude of the gradient, in which matter is shown: all of a rectangle; of an ellipse in the
/// box most in its middle, nothing at its border; of Kindlmann's triangle, which stands on its tip at no gradient and
/// is as wide as the box at its upper end, most along its middle.
enum class WidgetShape { rectangle, ellipse, triangle };
struct GradientWidget {
    WidgetShape shape = WidgetShape::rectangle;
    double value_low = 0, value_high = 1;          ///< data units
    double magnitude_low = 0, magnitude_high = 1;  ///< data units per mm
    double opacity = 1;                            ///< [0, 1]
    bool operator==(const GradientWidget&) const = default;
};

/// Colour and opacity on a grid over value and magnitude of the gradient: linear between its points, constant beyond.
struct GradientGrid {
    int columns = 0, rows = 0;                     ///< over values, over magnitudes; 0: none
    double value_low = 0, value_high = 1;          ///< data units: of the first and of the last column
    double magnitude_low = 0, magnitude_high = 1;  ///< data units per mm: of the first and of the last row
    std::vector<std::array<float, 4>> rgba{};  ///< row after row: colour in the function's rgb_space, opacity; [0, 1]
    bool operator==(const GradientGrid&) const = default;
};

enum class RgbSpace { srgb, linear };

/// Piecewise linear between points, constant outside. Two points of equal value make a step.
struct TransferFunction {
    std::vector<ControlPoint> points;  ///< at least one, values not falling
    RgbSpace rgb_space = RgbSpace::srgb;
    double opacity_unit = 1;                ///< the length that `opacity` belongs to, > 0 ...
    bool opacity_unit_is_mm = false;        ///< ... in millimetres, or else in units of the smallest voxel size
    std::string name;                       ///< preset, file or colour map it came from
    std::vector<GradientPoint> gradient{};  ///< magnitudes not falling, linear between, constant outside; empty: 1
    std::vector<GradientWidget> widgets{};  ///< of which the largest factor counts; empty: 1
    GradientGrid grid{};                    ///< of a function that over_gradient made; files do not hold it
    bool operator==(const TransferFunction&) const = default;
};

/// Colour and opacity at `value`, interpolated in the function's own rgb_space. It has no name.
CHIARO_EXPORT ControlPoint evaluate(const TransferFunction& tf, double value);

/// What the gradient's points, widgets and grid leave of the extinction of a value, [0, 1]: their product.
CHIARO_EXPORT double extinction_factor(const TransferFunction& tf, double value, double magnitude);

/// A function that has a grid's colours and opacities. Its points are each column's largest opacity and mean colour,
/// weighted by opacity: what is shown of whole rays. Throws Error{input} unless there are as many colours as the grid
/// has points, in range.
CHIARO_EXPORT TransferFunction over_gradient(GradientGrid grid);
/// The grid's colour and opacity there.
CHIARO_EXPORT std::array<double, 4> evaluate(const GradientGrid& grid, double value, double magnitude);

/// Throws Error{input} with one sentence unless the points are finite, in range and in order.
CHIARO_EXPORT void validate(const TransferFunction& tf);

/// Moves the function so that its [first, last] point values span the window.
CHIARO_EXPORT TransferFunction with_window(TransferFunction tf, double center, double width);

struct PresetInfo {
    std::string name, modality, sentence;
    bool stretched;
};
/// Our presets, then the colour maps (matplotlib's names; each also with `_r`).
CHIARO_EXPORT std::vector<PresetInfo> list_presets();

/// A preset (also by the name that 3D Slicer has for it, in lower case) or colour map by name. CT presets are in HU,
/// moved by Statistics::hu_zero and never stretched, but for ct-8bit; the others are stretched to the data.
/// Throws Error{usage} with "did you mean" for an unknown name.
CHIARO_EXPORT TransferFunction preset(const std::string& name, const Statistics& data);

/// A file of ours (JSON: the `transfer_function` object of a scene), else a preset or colour map of that name.
CHIARO_EXPORT TransferFunction load_transfer_function(const std::string& file_or_preset, const Statistics& data);
CHIARO_EXPORT TransferFunction parse_transfer_function(const std::string& json, const std::string& origin);
CHIARO_EXPORT std::string to_json(const TransferFunction& tf);

/// What kind of data this seems to be and which preset suits it, with the reason in words.
struct Guess {
    std::string modality, preset, reason;
};
CHIARO_EXPORT Guess guess(const Volume& volume, const Statistics& data);

/// Of a CT (in HU, or known by its air) how much of what is denser than -500 HU is not connected to its largest piece:
/// a table, a head rest. On every second voxel, or fewer, of volumes above 256³; 0 for what is no CT.
CHIARO_EXPORT double detached_share(const Volume& volume, const Statistics& data);

/// CSS colour name, `#rgb`, `#rrggbb` or `r,g,b` in [0, 1]; sRGB. Throws Error{usage} with "did you mean".
CHIARO_EXPORT Rgb parse_color(const std::string& text);

}  // namespace chiaro
