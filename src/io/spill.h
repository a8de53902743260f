// Voxels that exceed the memory while they are read lie in a file that has no name, mapped into memory: the system
// keeps the pages that are in use.
#pragma once
#include <cstdint>
#include <filesystem>

#include <chiaro/volume.h>

#include "io/helper_process.h"

namespace chiaro {

/// An empty file in the folder, which is made if need be; it is gone with its descriptor. Throws Error{output}.
Descriptor make_spill_file(const std::filesystem::path& folder);

/// Bytes that may be written below the folder, leaving a tenth of what is free; 0 where there is none, and for no
/// folder.
std::uint64_t free_disk_bytes(const std::filesystem::path& folder);

/// Voxels in such a file. Throws Error{output}.
VoxelBuffer make_spilled_voxels(const std::filesystem::path& folder, std::uint64_t bytes);

}  // namespace chiaro
