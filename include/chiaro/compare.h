// How far apart two pictures are, or two fields.
#pragma once
#include <chiaro/export.h>
#include <chiaro/image.h>
#include <chiaro/volume.h>

namespace chiaro {

/// Over the colours, premultiplied, and over alpha as a fourth channel where either picture is not opaque everywhere.
struct ImageDifference {
    double rmse = 0;  ///< root of the mean squared difference
    double psnr = 0;  ///< -20 log10(rmse) dB, for a peak of 1; infinite where the pictures are the same
    double ssim = 0;  ///< structural similarity of the luminance, at most 1; NaN for less than 11 pixels a side
    double max = 0;   ///< largest absolute difference
    double bias = 0;  ///< mean of b - a
};

/// Compares two pictures of one size, whatever their values stand for: linear light or display values, [0, 1] being
/// black to white. SSIM is that of Wang et al. 2004, "Image Quality Assessment": Gaussian window of 11 x 11 with
/// sigma 1.5, K1 0.01, K2 0.03, windows wholly inside, on the luminance of Rec. 709.
/// The result does not depend on the number of threads. Throws Error{input} for different sizes, for pictures without
/// pixels and for values that are not finite. About 0.1 µs a pixel and core; no memory to speak of.
CHIARO_EXPORT ImageDifference compare(const Frame& a, const Frame& b);

/// The display values of a picture, code / 255, multiplied by alpha: what is invisible cannot differ.
CHIARO_EXPORT Frame display_values(const Image& image);

struct FieldDifference {
    double rmse = 0;         ///< in the unit of the values
    double max = 0;          ///< largest absolute difference
    double bias = 0;         ///< mean of b - a
    double correlation = 0;  ///< Pearson's; NaN where a field is constant
};

/// Compares the values, after slope and intercept, of two volumes with the same dimensions (z, y, x) and components,
/// wherever they lie in the world. The result does not depend on the number of threads. Throws Error{input} for
/// different shapes and for values that are not finite. Two passes over the voxels, all cores.
CHIARO_EXPORT FieldDifference compare(const Volume& a, const Volume& b);

}  // namespace chiaro
