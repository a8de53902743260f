// The colour spaces in which other programs draw the line between two colours.
#pragma once
#include <chiaro/transfer_function.h>

namespace chiaro {

/// rgb: straight in sRGB. hsv: hue as it is numbered, red to violet; hsv_wrapped: the short way round. lab: CIE L*a*b*.
/// diverging: Moreland 2009, two hues over white. step: the later colour from the earlier one's place on.
enum class ColorSpace { rgb, hsv, hsv_wrapped, lab, diverging, step };

/// The colour at the share s of the way from a to b, all sRGB in [0, 1]. Cost: up to nine powers.
Rgb mixed(ColorSpace space, const Rgb& a, const Rgb& b, double s);

/// CIE 1976 L*a*b* of an sRGB colour under D65, and back; what lies outside sRGB is scaled and cut into it.
Rgb lab_from_srgb(const Rgb& rgb);
Rgb srgb_from_lab(const Rgb& lab);

}  // namespace chiaro
