// Pictures that are shown for a moment.
#pragma once
#include <chiaro/image.h>

#include <string>

namespace chiaro::server {

/// Qualities of slices, looks and the like: chosen by eye.
constexpr int near_quality = 88, far_quality = 70;

/// A JPEG file's bytes (4:2:0). Alpha is left out: colours over black. Throws Error{output}.
std::string encode_jpeg(const Image& image, int quality);

}  // namespace chiaro::server
