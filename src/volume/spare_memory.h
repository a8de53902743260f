// Memory that is kept from one volume to the next of its size.
#pragma once
#include <chiaro/volume.h>

#include <functional>

namespace chiaro {

/// The memory, which `back` is given when the buffer goes. It counts as borrowed, though it may be written.
VoxelBuffer lent(VoxelBuffer memory, std::function<void(VoxelBuffer)> back);

/// Bytes that are anything until they are written. Of 1 to 24 MiB they may be those of a buffer made so that went, of
/// which the process keeps two; such a buffer is lent. Throws as VoxelBuffer.
VoxelBuffer unspecified_bytes(std::size_t bytes);

}  // namespace chiaro
