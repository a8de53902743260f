// Radiance pictures (.hdr) in memory.
#pragma once
#include <chiaro/probe.h>

#include <cstddef>
#include <span>
#include <string>

namespace chiaro {

/// Whether the bytes begin as a Radiance picture does.
bool is_hdr(std::span<const std::byte> bytes);

/// RGBE of at most 100 megapixels, rows from the top left (-Y H +X W), plain or run-length encoded, old and new. A
/// component is mantissa × 2^(exponent - 136) (Ward, "Real Pixels", Graphics Gems II, 1991); what the header tells of
/// exposure is left alone. Throws Error{input}; `origin` names the file in the message.
Probe decode_hdr(std::span<const std::byte> bytes, const std::string& origin);

}  // namespace chiaro
