// What a volume is, as JSON.
#pragma once
#include <chiaro/volume.h>

#include <nlohmann/json.hpp>

namespace chiaro::cli {

using Json = nlohmann::ordered_json;

/// File, format, dimensions, type and geometry: what is known without looking at the voxels.
Json json_of(const Volume& volume);

/// "LPS", "RAS" or "unknown".
std::string_view name_of(World world);

}  // namespace chiaro::cli
