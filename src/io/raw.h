// Headerless files.
#pragma once
#include <chiaro/io.h>

#include <filesystem>
#include <string>

#include "io/wire.h"

namespace chiaro {

/// What a name such as `head_256x256x113_uint16.raw` says, where `stated` says nothing.
RawLayout completed_layout(RawLayout stated, const std::string& name);

/// What a headerless file holds.
struct RawFile {
    Volume volume;  ///< without voxels
    RawLayout layout;
    std::uint64_t bytes = 0;  ///< of the voxels
};
/// Throws as read_raw.
RawFile examine_raw(const std::filesystem::path& path, const ReadOptions& options);

/// Reads voxels as they lie. Throws Error{input} unless the layout is complete and the file holds exactly as many
/// bytes.
Volume read_raw(const std::filesystem::path& path, const ReadOptions& options, Progress& progress);

/// Fills the volume's voxels from where they lie in a file. Throws Error{input} where that cannot be read to their end.
void read_in_place(const VoxelsInFile& place, Volume& volume, Progress& progress);

}  // namespace chiaro
