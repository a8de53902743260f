// What the helper program tells the library, beside the voxels: one JSON object a line.
//   {"progress": 0.25}      any number of times
//   {"at": "file name"}     which of many files is being worked on
//   {"error": "sentence"}   or, with "too_large": true where the voxels exceed what is permitted,
//   {"volume": {...}}       at the end; the voxels lie in the memory file then, or, where they lie in one file as they
//                           are, as "place": {"path" (its bytes), "offset", "big_endian"} says
// A program that serves chunks sends {"volume": {...}, "levels": [...]} first, and then, for each line "LEVEL X Y Z" of
// its standard input, {"chunk": whether it was ever written} once the memory file holds it, or an error. One that waits
// for a server sends {"goes_on": true} as bytes come.
//
// What lies on a server is fetched by chiaro-fetch, which a decoder asks on a connection of its own for files below one
// address, a line each: "all BYTES PATH" (at most so many), "range FIRST BYTES PATH" or "last BYTES PATH" (at most so
// many). The answer: any number of "wait", then "part BYTES SIZE" with so many bytes behind it, of a file of SIZE; or
// "none STATUS", HTTP's for a file that is not there or forbidden; or "fault SENTENCE". Where what was fetched is kept
// (io/http_relay.h), "unless TAG " stands before a request, TAG being the ETag of what is there already, or "-"; the
// answer may then be "same", and that of a part has its ETag behind SIZE, or "-" where none is strong.
#pragma once
#include <chiaro/brick_source.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace chiaro {

/// Where a file holds its voxels.
struct VoxelsInFile {
    std::filesystem::path path;
    std::uint64_t offset = 0;  ///< bytes before the first
    bool big_endian = false;
};

/// Bytes of the largest chunk that is decoded.
inline constexpr std::uint64_t largest_chunk_bytes = std::uint64_t(1) << 30;

}  // namespace chiaro

namespace chiaro::wire {

/// File descriptors that the helper finds open.
constexpr int voxels_descriptor = 3, messages_descriptor = 4, fetch_descriptor = 5;

/// Whether a volume lies on a server.
inline bool is_url(std::string_view name) { return name.starts_with("http://") || name.starts_with("https://"); }

/// Everything of a volume but its voxels.
nlohmann::json header_to_json(const Volume& volume);
nlohmann::json to_json(const VoxelsInFile& place);
nlohmann::json to_json(const std::vector<ChunkedLevel>& levels);

/// The reverse. Throws std::exception for anything that is not such a header; says nothing about its sense.
Volume header_from_json(const nlohmann::json& json);
VoxelsInFile place_from_json(const nlohmann::json& json);
std::vector<ChunkedLevel> levels_from_json(const nlohmann::json& json);

}  // namespace chiaro::wire
