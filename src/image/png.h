// PNG in memory; files are in image_file.cpp.
#pragma once
#include <chiaro/image.h>

#include <cstddef>
#include <span>

namespace chiaro {

struct DecodedPng {
    Image image;
    Metadata metadata;
};
/// Any PNG of at most 100 megapixels as 8 bit RGB or RGBA. Throws Error{input}; `origin` names the file in the message.
DecodedPng decode_png(std::span<const std::byte> bytes, const std::string& origin);

}  // namespace chiaro
