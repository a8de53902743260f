// The bytes of an array of VTK's XML files: base64 or not, in compressed blocks or not.
#pragma once
#include "decode/byte_source.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace chiaro::decode {

/// How the whole file stores its binary arrays.
struct VtiCoding {
    bool big_endian = false;
    bool wide_header = false;  ///< counts before the data are of 64 bits, not 32
    std::string compressor;    ///< empty: none
};

/// Bytes of text in memory, which must outlive the source.
std::unique_ptr<ByteSource> open_memory(std::string_view text);

/// What base64 text stands for; the text ends at its source's end or before a '<'. Padding may come in its midst, as
/// VTK codes header and data apart.
std::unique_ptr<ByteSource> open_base64(std::unique_ptr<ByteSource> text);

/// The values of one array: `stored` begins with the counts that VTK puts before them. Throws Error{input} unless they
/// say that exactly `bytes` follow, and `available` bytes can hold them.
std::unique_ptr<ByteSource> open_vti_array(std::unique_ptr<ByteSource> stored, const VtiCoding& coding,
                                           std::uint64_t bytes, std::uint64_t available);

}  // namespace chiaro::decode
