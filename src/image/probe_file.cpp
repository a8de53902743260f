// A light probe by name or from a file.
#include <chiaro/error.h>
#include <chiaro/probe.h>

#include "core/file_contents.h"
#include "image/exr.h"
#include "image/hdr.h"

namespace chiaro {
namespace {

Probe probe_of(const Frame& frame, const std::string& source) {
    std::vector<float> rgb;
    rgb.reserve(frame.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4)
        rgb.insert(rgb.end(), frame.rgba.begin() + i, frame.rgba.begin() + i + 3);
    try {
        return Probe(frame.width, frame.height, std::move(rgb));
    } catch (const Error& error) {
        throw Error(error.code(), source + ": " + error.what());
    }
}

}  // namespace

Probe load_probe(const std::string& source) {
    if (is_probe_name(source)) return builtin_probe(source);
    const std::vector<std::byte> bytes = file_bytes(source);
    if (is_hdr(bytes)) return decode_hdr(bytes, source);
    if (is_exr(bytes)) return probe_of(decode_exr(bytes, source).frame, source);
    throw Error(ErrorCode::input, source + ": is neither a Radiance picture (.hdr) nor an OpenEXR file");
}

}  // namespace chiaro
