// One moment's bytes of data in which those of several alternate.
#pragma once
#include "decode/payload.h"

namespace chiaro::decode {

/// Of files that hold `share` bytes of voxels each, plain or deflated, as if they were one behind the other.
std::unique_ptr<ByteSource> open_moment(const Payload& payload, std::uint64_t share);

}  // namespace chiaro::decode
