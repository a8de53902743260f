// Occupancy on a GPU, which keeps it there for its rays.
#pragma once
#include "classify/medium.h"
#include "cuda/device_cache.h"

namespace chiaro {

/// The codes as make_occupancy finds them, here and there.
struct GpuOccupancy {
    std::vector<std::uint8_t> codes;
    cuda::Array<std::byte> on_gpu;
};

/// On the stream's GPU. Cost: a thread a cell; memory 5 bytes a cell; four bytes go up for an entry of
/// the optical table, one a cell comes back.
GpuOccupancy occupancy_on_gpu(cuda::Stream& stream, const DeviceVolume::Data& volume, const RangeTest& is_visible);

}  // namespace chiaro
