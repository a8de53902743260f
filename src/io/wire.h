// What the helper program tells the library, beside the voxels: one JSON object a line.
//   {"progress": 0.25}      any number of times
//   {"at": "file name"}     which of many files is being worked on
//   {"error": "sentence"}   or, with "too_large": true where the voxels exceed what is permitted,
//   {"volume": {...}}       at the end; the voxels lie in the memory file then, or, where their place was asked for,
//                           as "place": {"path", "offset", "big_endian"} says
#pragma once
#include <chiaro/volume.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace chiaro {

/// Where a file holds its voxels.
struct VoxelsInFile {
    std::filesystem::path path;
    std::uint64_t offset = 0;  ///< bytes before the first
    bool big_endian = false;
};

}  // namespace chiaro

namespace chiaro::wire {

/// File descriptors that the helper finds open.
constexpr int voxels_descriptor = 3, messages_descriptor = 4;

/// Everything of a volume but its voxels.
nlohmann::json header_to_json(const Volume& volume);
nlohmann::json to_json(const VoxelsInFile& place);

/// The reverse. Throws std::exception for anything that is not such a header; says nothing about its sense.
Volume header_from_json(const nlohmann::json& json);
VoxelsInFile place_from_json(const nlohmann::json& json);

}  // namespace chiaro::wire
