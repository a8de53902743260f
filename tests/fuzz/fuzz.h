// What the fuzz targets share. Each target is one file with LLVMFuzzerTestOneInput: it hands bytes to a parser and lets
// nothing pass but an Error; whatever else happens - another exception, a wrong address, undefined behaviour, seconds
// without an end, gigabytes - libFuzzer and the sanitizers report.
#pragma once
#include <chiaro/error.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

namespace fuzz {

inline std::string text(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

inline std::span<const std::byte> bytes(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const std::byte*>(data), size};
}

/// Runs `parse`; a refusal must be a sentence, and the file's fault.
template <class Parse>
int refusing(const Parse& parse, bool usage_too = false) {
    try {
        parse();
    } catch (const chiaro::Error& error) {
        const bool is_right =
            error.code() == chiaro::ErrorCode::input || (usage_too && error.code() == chiaro::ErrorCode::usage);
        if (!is_right || std::string(error.what()).empty()) std::abort();
    }
    return 0;
}

/// A file in memory with these bytes: its name, the same each time.
std::string file_with(const std::uint8_t* data, std::size_t size, const char* ending);

/// As chiaro-decode would: the volume's header goes over the wire and is checked there.
void decode(const char* format, const std::uint8_t* data, std::size_t size, const char* ending);

}  // namespace fuzz
