// PNG in memory; files are in image_file.cpp.
#pragma once
#include <chiaro/image.h>

#include <cstddef>
#include <span>

namespace chiaro {

/// 8 bit RGB or RGBA with an sRGB chunk; each text as tEXt where it is ASCII, else as iTXt. Throws Error{output} for an
/// image without pixels or a keyword that PNG does not allow (1..79 printable ASCII characters).
std::vector<std::byte> encode_png(const Image& image, const Metadata& metadata);

struct DecodedPng {
    Image image;
    Metadata metadata;
};
/// Any PNG of at most 100 megapixels as 8 bit RGB or RGBA. Throws Error{input}; `origin` names the file in the message.
DecodedPng decode_png(std::span<const std::byte> bytes, const std::string& origin);

}  // namespace chiaro
