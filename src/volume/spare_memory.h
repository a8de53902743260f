// Memory that is kept from one volume to the next of its size.
#pragma once
#include <chiaro/volume.h>

namespace chiaro {

/// Bytes that are anything until they are written. Of 1 to 24 MiB they may be those of a buffer made so that went, of
/// which the process keeps two; such a buffer counts as borrowed, though it may be written. Throws as VoxelBuffer.
VoxelBuffer unspecified_bytes(std::size_t bytes);

}  // namespace chiaro
