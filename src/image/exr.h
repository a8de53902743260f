// OpenEXR in memory; files are in image_file.cpp.
#pragma once
#include <chiaro/image.h>

#include <cstddef>
#include <span>

namespace chiaro {

/// Float RGBA, ZIP compression, each text as an attribute of its name. Throws Error{output} for a frame without pixels.
std::vector<std::byte> encode_exr(const Frame& frame, const Metadata& metadata, const Progress* progress = nullptr);

/// Whether the bytes begin as an OpenEXR file does.
bool is_exr(std::span<const std::byte> bytes);

struct DecodedExr {
    Frame frame;
    Metadata metadata;
};
/// The data window of the first part of at most 100 megapixels: R, G and B, with A (else 1), of any type and order.
/// Throws Error{input}; `origin` names the file in the message.
DecodedExr decode_exr(std::span<const std::byte> bytes, const std::string& origin);
/// The texts alone.
Metadata decode_exr_metadata(std::span<const std::byte> bytes, const std::string& origin);

}  // namespace chiaro
