// The text form of every kind of setting: what a flag takes, what a scene file holds, what the documentation shows.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/error.h>
#include <chiaro/export.h>
#include <chiaro/image.h>
#include <chiaro/io.h>
#include <chiaro/lighting.h>
#include <chiaro/marks.h>
#include <chiaro/medium.h>
#include <chiaro/render.h>
#include <chiaro/settings.h>
#include <chiaro/slice.h>
#include <chiaro/volume.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace chiaro {

/// The names of an enum's values, in order.
constexpr auto names_of(Projection) { return std::to_array<std::string_view>({"perspective", "orthographic"}); }
constexpr auto names_of(View) {
    return std::to_array<std::string_view>({"anterior", "posterior", "left", "right", "superior", "inferior"});
}
constexpr auto names_of(Fit) { return std::to_array<std::string_view>({"visible", "volume"}); }
constexpr auto names_of(Shading) { return std::to_array<std::string_view>({"none", "lambert", "phong"}); }
constexpr auto names_of(Method) {
    return std::to_array<std::string_view>({"none", "spao", "visibility", "histogram", "transport", "reference"});
}
constexpr auto names_of(SpaoFilter) {
    return std::to_array<std::string_view>({"auto", "nbuffer", "mipmap", "hybrid", "exact"});
}
constexpr auto names_of(SpaoModel) { return std::to_array<std::string_view>({"paper", "thick", "corrected"}); }
constexpr auto names_of(VisibilityTraversal) {
    return std::to_array<std::string_view>({"sweep", "sheared", "hierarchical", "full"});
}
constexpr auto names_of(VisibilityModel) { return std::to_array<std::string_view>({"corrected", "paper"}); }
constexpr auto names_of(ShWindow) { return std::to_array<std::string_view>({"none", "hann", "lanczos"}); }
constexpr auto names_of(ShStorage) { return std::to_array<std::string_view>({"u8", "f16", "f32"}); }
constexpr auto names_of(HistogramPath) { return std::to_array<std::string_view>({"fast", "sweep", "exact"}); }
constexpr auto names_of(HistogramPacking) {
    return std::to_array<std::string_view>({"paper", "uniform", "cumulative"});
}
constexpr auto names_of(HistogramMetric) { return std::to_array<std::string_view>({"l2", "l1", "lmax"}); }
constexpr auto names_of(HistogramModel) { return std::to_array<std::string_view>({"corrected", "paper"}); }
constexpr auto names_of(ReferenceQuantity) {
    return std::to_array<std::string_view>(
        {"obscurance", "ao", "ao-cosine", "visibility", "mean-radiance", "radiance"});
}
constexpr auto names_of(ReferenceMedium) { return std::to_array<std::string_view>({"voxels", "trilinear"}); }
constexpr auto names_of(SurfaceModel) { return std::to_array<std::string_view>({"none", "auto"}); }
constexpr auto names_of(Mode) {
    return std::to_array<std::string_view>({"dvr", "iso", "mip", "minip", "mean", "additive"});
}
constexpr auto names_of(Classification) { return std::to_array<std::string_view>({"post", "pre", "preintegrated"}); }
constexpr auto names_of(Compositing) { return std::to_array<std::string_view>({"front-to-back", "back-to-front"}); }
constexpr auto names_of(RaySetup) { return std::to_array<std::string_view>({"box", "raster"}); }
constexpr auto names_of(Interpolation) {
    return std::to_array<std::string_view>({"auto", "linear", "cubic", "smooth", "texture"});
}
constexpr auto names_of(ColorMode) { return std::to_array<std::string_view>({"linear", "display"}); }
constexpr auto names_of(SliceSampling) { return std::to_array<std::string_view>({"linear", "nearest"}); }
constexpr auto names_of(SliceLayout) {
    return std::to_array<std::string_view>({"volume", "linked", "axial", "coronal", "sagittal", "oblique"});
}
constexpr auto names_of(SliceColors) { return std::to_array<std::string_view>({"grey", "transfer"}); }
constexpr auto names_of(SliceSide) { return std::to_array<std::string_view>({"radiological", "neurological"}); }
constexpr auto names_of(MarkKind) {
    return std::to_array<std::string_view>(
        {"distance", "polyline", "angle", "ball", "box", "profile", "arrow", "text"});
}
constexpr auto names_of(Tone) { return std::to_array<std::string_view>({"none", "aces"}); }
constexpr auto names_of(ComponentsAs) { return std::to_array<std::string_view>({"auto", "rgb", "channels"}); }
constexpr auto names_of(NrrdEncoding) { return std::to_array<std::string_view>({"raw", "gzip"}); }
constexpr auto names_of(Isa) {
    return std::to_array<std::string_view>({"scalar", "x86-64-v2", "x86-64-v3", "x86-64-v4", "x86-64-v4-gather"});
}
constexpr auto names_of(VoxelType) {
    return std::to_array<std::string_view>(
        {"uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"});
}
template <class E>
concept Named = std::is_enum_v<E> && requires(E e) {
    names_of(e);
};

/// Text of a value, which from_text gives back; "" for an optional that is not set.
CHIARO_EXPORT std::string to_text(bool value);
CHIARO_EXPORT std::string to_text(int value);
CHIARO_EXPORT std::string to_text(std::uint64_t value);
CHIARO_EXPORT std::string to_text(double value);
CHIARO_EXPORT std::string to_text(const std::string& value);
CHIARO_EXPORT std::string to_text(const Vec3& value);
CHIARO_EXPORT std::string to_text(const Rgb& value);
CHIARO_EXPORT std::string to_text(const std::pair<double, double>& value);
CHIARO_EXPORT std::string to_text(const std::array<int, 3>& value);
CHIARO_EXPORT std::string to_text(const std::array<double, 6>& value);
CHIARO_EXPORT std::string to_text(const Matrix4& value);
CHIARO_EXPORT std::string to_text(const ClipPlane& value);
CHIARO_EXPORT std::string to_text(const IsoSurface& value);
CHIARO_EXPORT std::string to_text(const Light& value);
CHIARO_EXPORT std::string to_text(const ShSampling& value);
CHIARO_EXPORT std::string to_text(const Bounces& value);
CHIARO_EXPORT std::string to_text(const ProbeExposure& value);
CHIARO_EXPORT std::string to_text(const HistogramEffects& value);  ///< "ao,bleeding"; "none"
CHIARO_EXPORT std::string to_text(int width, int height);
CHIARO_EXPORT std::string to_text(const Rgb& color, bool transparent, bool probe);  ///< of what lies behind the probe
std::string to_text(Named auto value) { return std::string(names_of(value)[std::size_t(value)]); }
template <class T>
std::string to_text(const std::optional<T>& value) {
    return value ? to_text(*value) : "";
}

/// Of a setting that repeats: its values with ';' between.
template <class T>
std::string to_text(const std::vector<T>& values) {
    std::string text;
    for (const T& value : values) text += (text.empty() ? "" : ";") + to_text(value);
    return text;
}

/// Sets the fields from text. Throws Error{usage} that says what was expected, or what is wrong with the text.
CHIARO_EXPORT void from_text(std::string_view text, bool& value);
CHIARO_EXPORT void from_text(std::string_view text, int& value);
CHIARO_EXPORT void from_text(std::string_view text, std::uint64_t& value);
CHIARO_EXPORT void from_text(std::string_view text, double& value);
CHIARO_EXPORT void from_text(std::string_view text, std::string& value);
CHIARO_EXPORT void from_text(std::string_view text, Vec3& value);  ///< also an axis: x, -z
CHIARO_EXPORT void from_text(std::string_view text, Rgb& value);
CHIARO_EXPORT void from_text(std::string_view text, std::pair<double, double>& value);
CHIARO_EXPORT void from_text(std::string_view text, std::array<int, 3>& value);
CHIARO_EXPORT void from_text(std::string_view text, std::array<double, 6>& value);
CHIARO_EXPORT void from_text(std::string_view text, Matrix4& value);
CHIARO_EXPORT void from_text(std::string_view text, ClipPlane& value);
CHIARO_EXPORT void from_text(std::string_view text, IsoSurface& value);
CHIARO_EXPORT void from_text(std::string_view text, Light& value);
CHIARO_EXPORT void from_text(std::string_view text, ShSampling& value);
CHIARO_EXPORT void from_text(std::string_view text, Bounces& value);
CHIARO_EXPORT void from_text(std::string_view text, ProbeExposure& value);
CHIARO_EXPORT void from_text(std::string_view text, HistogramEffects& value);
CHIARO_EXPORT void from_text(std::string_view text, int& width, int& height);
CHIARO_EXPORT void from_text(std::string_view text, Rgb& color, bool& transparent,
                             bool& probe);  ///< "probe" leaves the others

/// Position of `text` among the names; throws Error{usage} with "did you mean".
CHIARO_EXPORT std::size_t index_among(std::string_view text, std::span<const std::string_view> names);

void from_text(std::string_view text, Named auto& value) {
    using E = std::remove_reference_t<decltype(value)>;
    value = E(index_among(text, names_of(value)));
}
/// Accepts "fluence" too, an older name of mean-radiance.
inline void from_text(std::string_view text, ReferenceQuantity& value) {
    value = ReferenceQuantity(index_among(text == "fluence" ? "mean-radiance" : text, names_of(value)));
}
/// Accepts "exact" too, an older name of linear.
inline void from_text(std::string_view text, Interpolation& value) {
    value = Interpolation(index_among(text == "exact" ? "linear" : text, names_of(value)));
}
template <class T>
void from_text(std::string_view text, std::optional<T>& value) {
    from_text(text, value.emplace());
}

template <class T>
void from_text(std::string_view text, std::vector<T>& values) {
    values.clear();
    for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
        const std::size_t end = std::min(text.find(';', begin), text.size());
        from_text(text.substr(begin, end - begin), values.emplace_back());
        begin = end + 1;
    }
}

/// How a value is written where its setting does not say: "perspective|orthographic", "X,Y,Z"; "" for a switch.
std::string form_of(const Named auto& value) {
    std::string form;
    for (std::string_view name : names_of(value)) form += (form.empty() ? "" : "|") + std::string(name);
    return form;
}
inline std::string form_of(const bool&) { return ""; }
inline std::string form_of(const Vec3&) { return "X,Y,Z"; }
inline std::string form_of(const auto&...) { return "N"; }
template <class T>
std::string form_of(const std::optional<T>&) {
    return form_of(T{});
}

/// The numbers of "1,2", "64x64x64" or "5"; nothing unless all pieces are finite numbers.
CHIARO_EXPORT std::vector<double> numbers_in(std::string_view text);
/// "0 to 1", "above 0 mm", ...; "" when every number will do.
CHIARO_EXPORT std::string range_of(const Setting& setting);
/// Throws Error{usage} unless every number in the text is in the setting's range.
CHIARO_EXPORT void check_range(const Setting& setting, std::string_view text);

/// Text of a setting's value. A bool is a switch, turned by a name that begins with "no-", or a choice of two where its
/// setting has a form "off|on". A whole number is one of a few where its setting has a form "2|4".
std::string value_text(const Setting&, const auto&... fields) { return to_text(fields...); }
CHIARO_EXPORT std::string value_text(const Setting& setting, const bool& field);

/// The inverse of value_text. Throws Error{usage}.
void read_value(const Setting&, std::string_view text, auto&... fields) { from_text(text, fields...); }
CHIARO_EXPORT void read_value(const Setting& setting, std::string_view text, bool& field);
CHIARO_EXPORT void read_value(const Setting& setting, std::string_view text, int& field);

/// Sets the fields of a setting from text, within its range. Throws Error{code} that begins with `who` ("--step 0").
template <class... Fields>
void set(const Setting& setting, std::string_view text, const std::string& who, ErrorCode code, Fields&... fields) {
    try {
        read_value(setting, text, fields...);
        check_range(setting, text);
        check_range(setting, value_text(setting, fields...));  // an axis is told by its name, too: "-z"
    } catch (const Error& error) {
        throw Error(code, who + ": " + error.what());
    }
}

}  // namespace chiaro
