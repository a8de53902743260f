// Pictures of differences, and several pictures on one sheet.
#pragma once
#include <chiaro/export.h>
#include <chiaro/image.h>

namespace chiaro {

/// Where `picture` is brighter than `truth` (red) or darker (blue), in luminance (Rec. 709), over black; white where
/// they are the same, full colour from a difference of `full` on. Throws Error{input} for different sizes.
CHIARO_EXPORT Image difference_image(const Frame& image, const Frame& ground_truth, double full);

/// The least of 1, 2 and 5 times a power of ten that no more than one pixel in `1 / share` exceeds in |luminance
/// difference|.
CHIARO_EXPORT double difference_scale(const Frame& image, const Frame& ground_truth, double share = 0.005);

struct SheetCell {
    Image image;
    std::string caption;  ///< one line: a-z, 0-9 and . - + %
};

/// Rows of pictures of one size, each with its caption below, on dark gray. A row may be shorter than others, and an
/// image empty. Throws Error{input} for different sizes.
CHIARO_EXPORT Image contact_sheet(const std::vector<std::vector<SheetCell>>& rows);

}  // namespace chiaro
