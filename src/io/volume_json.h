// What a volume is, as JSON.
#pragma once
#include <chiaro/transfer_function.h>
#include <chiaro/volume.h>

#include <nlohmann/json.hpp>

namespace chiaro {

/// Keys keep the order in which they are written.
using OrderedJson = nlohmann::ordered_json;

/// File, format, dimensions, type and geometry: what is known without looking at the voxels.
OrderedJson json_of(const Volume& volume);

/// What `chiaro info --json` tells.
OrderedJson info_of(const Volume& volume, const Statistics& statistics, const Guess& guess);

/// "LPS", "RAS" or "unknown".
std::string_view name_of(World world);

}  // namespace chiaro
