// What the helper program tells the library, beside the voxels: one JSON object a line.
//   {"progress": 0.25}      any number of times
//   {"at": "file name"}     which of many files is being worked on
//   {"error": "sentence"}   or, with "too_large": true where the voxels exceed what is permitted,
//   {"volume": {...}}       at the end; the voxels lie in the memory file then
#pragma once
#include <chiaro/volume.h>

#include <nlohmann/json_fwd.hpp>

namespace chiaro::wire {

/// File descriptors that the helper finds open.
constexpr int voxels_descriptor = 3, messages_descriptor = 4;

/// Everything of a volume but its voxels.
nlohmann::json header_to_json(const Volume& volume);

/// The reverse. Throws std::exception for anything that is not such a header; says nothing about its sense.
Volume header_from_json(const nlohmann::json& json);

}  // namespace chiaro::wire
