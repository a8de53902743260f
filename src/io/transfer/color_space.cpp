#include "io/transfer/color_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/srgb.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;

Rgb lerp(const Rgb& a, const Rgb& b, double s) {
    return {std::lerp(a[0], b[0], s), std::lerp(a[1], b[1], s), std::lerp(a[2], b[2], s)};
}

/// Hue, saturation and value in [0, 1] (A. R. Smith 1978); a grey has hue 0.
Rgb hsv_from_rgb(const Rgb& rgb) {
    const auto [low, high] = std::minmax({rgb[0], rgb[1], rgb[2]});
    const double span = high - low;
    if (span <= 0) return {0, 0, high};
    double sixths = 0;
    if (high == rgb[0])
        sixths = (rgb[1] - rgb[2]) / span;
    else if (high == rgb[1])
        sixths = 2 + (rgb[2] - rgb[0]) / span;
    else
        sixths = 4 + (rgb[0] - rgb[1]) / span;
    return {sixths < 0 ? sixths / 6 + 1 : sixths / 6, span / high, high};
}

Rgb rgb_from_hsv(const Rgb& hsv) {
    Rgb rgb;
    for (int c = 0; c < 3; ++c) {  // each component is a trapezium over the hue, a third of the circle apart
        const double k = std::fmod(hsv[0] * 6 + (c == 0 ? 5 : c == 1 ? 3 : 1), 6.0);
        rgb[c] = hsv[2] * (1 - hsv[1] * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    }
    return rgb;
}

Rgb mixed_hsv(const Rgb& a, const Rgb& b, double s, bool wrapped) {
    Rgb from = hsv_from_rgb(a), to = hsv_from_rgb(b);
    if (wrapped && std::abs(from[0] - to[0]) > 0.5) (from[0] > to[0] ? from : to)[0] -= 1;
    Rgb hsv = lerp(from, to, s);
    if (hsv[0] < 0) hsv[0] += 1;
    return rgb_from_hsv(hsv);
}

// Moreland 2009, "Diverging color maps for scientific visualization": L*a*b* in polar coordinates, where M is the
// distance from black, s the angle of saturation and h that of hue.
struct Msh {
    double m, s, h;
};

Msh msh_from_lab(const Rgb& lab) {
    const double m = std::hypot(lab[0], lab[1], lab[2]);
    const double s = m > 0.001 ? std::acos(std::clamp(lab[0] / m, -1.0, 1.0)) : 0;
    return {m, s, s > 0.001 ? std::atan2(lab[2], lab[1]) : 0};
}

Rgb lab_from_msh(const Msh& c) {
    return {c.m * std::cos(c.s), c.m * std::sin(c.s) * std::cos(c.h), c.m * std::sin(c.s) * std::sin(c.h)};
}

/// A hue for an unsaturated end, turned so that the change looks even (the published AdjustHue).
double spun_hue(const Msh& saturated, double unsaturated_m) {
    if (saturated.m >= unsaturated_m - 0.1) return saturated.h;
    const double spin = saturated.s * std::sqrt(unsaturated_m * unsaturated_m - saturated.m * saturated.m) /
                        (saturated.m * std::sin(saturated.s));
    return saturated.h > -0.3 * pi ? saturated.h + spin : saturated.h - spin;  // away from purple
}

double angle_between(double a, double b) {
    const double d = std::abs(a - b);
    return d > pi ? 2 * pi - d : d;
}

Rgb mixed_diverging(const Rgb& a, const Rgb& b, double s) {
    constexpr double grey = 0.05;  // radians of saturation below which a colour has no hue
    Msh from = msh_from_lab(lab_from_srgb(a)), to = msh_from_lab(lab_from_srgb(b));
    if (from.s > grey && to.s > grey && angle_between(from.h, to.h) > 0.33 * pi) {  // white between two colours
        const Msh white{std::max({from.m, to.m, 88.0}), 0, 0};
        (s < 0.5 ? to : from) = white;
        s = s < 0.5 ? 2 * s : 2 * s - 1;
    }
    if (from.s < grey && to.s > grey)
        from.h = spun_hue(to, from.m);
    else if (to.s < grey && from.s > grey)
        to.h = spun_hue(from, to.m);
    return srgb_from_lab(
        lab_from_msh({std::lerp(from.m, to.m, s), std::lerp(from.s, to.s, s), std::lerp(from.h, to.h, s)}));
}

// IEC 61966-2-1: XYZ of the primaries under D65, and the inverse as the standard rounds it.
constexpr double xyz_of_rgb[3][3] = {{.4124, .3576, .1805}, {.2126, .7152, .0722}, {.0193, .1192, .9505}};
constexpr double rgb_of_xyz[3][3] = {{3.2406, -1.5372, -.4986}, {-.9689, 1.8758, .0415}, {.0557, -.2040, 1.0570}};
constexpr double white[3] = {.9505, 1, 1.089};  // the rows' sums

Rgb product(const double (&m)[3][3], const Rgb& v) {
    Rgb result;
    for (int i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return result;
}

double lab_curve(double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; }
double inverse_lab_curve(double f) { return f * f * f > 0.008856 ? f * f * f : (f - 16.0 / 116) / 7.787; }

}  // namespace

Rgb lab_from_srgb(const Rgb& rgb) {
    const Rgb xyz = product(xyz_of_rgb, {linear_from_srgb(rgb[0]), linear_from_srgb(rgb[1]), linear_from_srgb(rgb[2])});
    const double x = lab_curve(xyz[0] / white[0]), y = lab_curve(xyz[1] / white[1]), z = lab_curve(xyz[2] / white[2]);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Rgb srgb_from_lab(const Rgb& lab) {
    const double y = (lab[0] + 16) / 116, x = y + lab[1] / 500, z = y - lab[2] / 200;
    Rgb rgb = product(rgb_of_xyz, {white[0] * inverse_lab_curve(x), white[1] * inverse_lab_curve(y),
                                   white[2] * inverse_lab_curve(z)});
    for (double& c : rgb) c = c <= 0.0031308 ? 12.92 * c : srgb_from_linear(c);
    const double most = std::max({rgb[0], rgb[1], rgb[2], 1.0});
    for (double& c : rgb) c = std::max(c / most, 0.0);
    return rgb;
}

Rgb mixed(ColorSpace space, const Rgb& a, const Rgb& b, double s) {
    switch (space) {
        case ColorSpace::rgb:
            return lerp(a, b, s);
        case ColorSpace::hsv:
            return mixed_hsv(a, b, s, false);
        case ColorSpace::hsv_wrapped:
            return mixed_hsv(a, b, s, true);
        case ColorSpace::lab:
            return srgb_from_lab(lerp(lab_from_srgb(a), lab_from_srgb(b), s));
        case ColorSpace::diverging:
            return mixed_diverging(a, b, s);
        case ColorSpace::step:
            return s > 0 ? b : a;
    }
    return a;
}

}  // namespace chiaro
