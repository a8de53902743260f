// Structural similarity.
#pragma once
#include <chiaro/image.h>

namespace chiaro {

/// Mean SSIM of the luminance (Wang et al. 2004, eq. 13 and 17) of two pictures of one size; NaN where the window of
/// 11 x 11 pixels does not fit.
double ssim(const Frame& a, const Frame& b);

}  // namespace chiaro
