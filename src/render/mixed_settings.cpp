#include "render/mixed_settings.h"

#include <chiaro/describe.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <type_traits>

namespace chiaro {
namespace {

/// The number that begins at `at`, with its length; none where none does, or within a word.
std::pair<double, std::size_t> number_at(std::string_view text, std::size_t at) {
    if (at > 0 && std::isalnum(static_cast<unsigned char>(text[at - 1]))) return {0, 0};
    double number = 0;
    const char* begin = text.data() + at;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    return error == std::errc() ? std::pair{number, std::size_t(end - begin)} : std::pair{0.0, std::size_t(0)};
}

/// Two texts of a setting with their numbers mixed; nothing where anything else in them differs.
std::optional<std::string> mixed_text(std::string_view a, std::string_view b, double t) {
    std::string text;
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        const auto [x, x_length] = number_at(a, i);
        const auto [y, y_length] = number_at(b, j);
        if ((x_length > 0) != (y_length > 0)) return {};
        if (x_length > 0) {
            text += to_text(x == y ? x : (1 - t) * x + t * y);
            i += x_length, j += y_length;
        } else if (a[i] == b[j]) {
            text += a[i];
            ++i, ++j;
        } else {
            return {};
        }
    }
    if (i < a.size() || j < b.size()) return {};
    return text;
}

/// Settings that have numbers between their values.
template <class T>
constexpr bool is_continuous = !std::is_integral_v<T> && !std::is_enum_v<T> && !std::is_same_v<T, std::string>;

std::string name_of(const Setting& setting) { return std::string(setting.name) + "|" + std::string(setting.key); }

bool is_mixed(const Setting& setting) {
    return setting.scene_form != SceneForm::custom && setting.scene_form != SceneForm::surfaces &&
           !setting.key.starts_with("camera.") && !setting.key.starts_with("volume.") &&
           !setting.key.starts_with("slices.");
}

std::map<std::string, std::string> texts_of(const Scene& scene) {
    std::map<std::string, std::string> texts;
    for_each_setting(
        [&](const Setting& setting, const auto&... fields) {
            if (!is_mixed(setting)) return;
            std::string text = value_text(setting, fields...);
            if (setting.key == "clip.box" && text.empty()) text = "0,1,0,1,0,1";
            texts[name_of(setting)] = std::move(text);
        },
        scene);
    return texts;
}

ControlPoint mixed(const ControlPoint& a, const ControlPoint& b, double t) {
    ControlPoint point = a;
    point.value += t * (b.value - a.value), point.opacity += t * (b.opacity - a.opacity);
    for (std::size_t c = 0; c < 3; ++c) point.rgb[c] += t * (b.rgb[c] - a.rgb[c]);
    return point;
}

TransferFunction mixed(const TransferFunction& a, const TransferFunction& b, double t) {
    if (a.rgb_space != b.rgb_space || a.opacity_unit_is_mm != b.opacity_unit_is_mm) return a;
    TransferFunction tf = a;
    tf.opacity_unit += t * (b.opacity_unit - a.opacity_unit);
    for (std::size_t i = 0; a.gradient.size() == b.gradient.size() && i < tf.gradient.size(); ++i) {
        tf.gradient[i].magnitude += t * (b.gradient[i].magnitude - a.gradient[i].magnitude);
        tf.gradient[i].opacity += t * (b.gradient[i].opacity - a.gradient[i].opacity);
    }
    if (a.points.size() == b.points.size()) {
        for (std::size_t i = 0; i < tf.points.size(); ++i) tf.points[i] = mixed(a.points[i], b.points[i], t);
        return tf;
    }
    // The mean of both at every value: points where either has one. A step keeps both its sides.
    std::vector<double> values;
    for (const auto* one : {&a, &b})
        for (std::size_t i = 0; i < one->points.size(); ++i) {
            const double v = one->points[i].value;
            values.push_back(v);
            if (i > 0 && one->points[i - 1].value == v) values.push_back(std::nextafter(v, -INFINITY));
        }
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    tf.points.clear();
    for (const double v : values) {
        ControlPoint point = mixed(evaluate(a, v), evaluate(b, v), t);
        point.value = v;
        tf.points.push_back(point);
    }
    return tf;
}

IsoSurface mixed(const IsoSurface& a, const IsoSurface& b, double t) {
    IsoSurface surface = a;
    surface.value += t * (b.value - a.value), surface.opacity += t * (b.opacity - a.opacity);
    if (a.color && b.color)
        for (std::size_t c = 0; c < 3; ++c) (*surface.color)[c] += t * ((*b.color)[c] - (*a.color)[c]);
    return surface;
}

}  // namespace

Scene mixed_settings(const Scene& a, const Scene& b, double t) {
    if (t >= 1) return b;
    Scene scene = a;
    if (t <= 0) return scene;
    const auto from = texts_of(a), to = texts_of(b);
    for_each_setting(
        [&](const Setting& setting, auto&... fields) {
            if constexpr ((is_continuous<std::remove_cvref_t<decltype(fields)>> && ...)) {
                if (!is_mixed(setting)) return;
                const std::string &x = from.at(name_of(setting)), &y = to.at(name_of(setting));
                if (x == y || x.empty()) return;
                if (const auto text = mixed_text(x, y, t))
                    set(setting, *text, std::string(setting.key), ErrorCode::input, fields...);
            }
        },
        scene);
    scene.read.time = int(std::lround(a.read.time + t * (b.read.time - a.read.time)));  // through all between
    if (a.iso.size() == b.iso.size())
        for (std::size_t i = 0; i < a.iso.size(); ++i) scene.iso[i] = mixed(a.iso[i], b.iso[i], t);
    if (a.transfer.points && b.transfer.points)
        scene.transfer.points = mixed(*a.transfer.points, *b.transfer.points, t);
    return scene;
}

}  // namespace chiaro
