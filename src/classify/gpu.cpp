#include "classify/gpu.h"

#include "classify/launch_gpu.h"

namespace chiaro {

GpuOccupancy occupancy_on_gpu(cuda::Stream& stream, const DeviceVolume::Data& volume, const RangeTest& is_visible) {
    const auto [nx, ny, nz] = volume.cells.count;
    const std::int64_t row = nx, slice = row * ny, cells = slice * nz;
    GpuOccupancy made{std::vector<std::uint8_t>(std::size_t(cells) + kernel::spare_bytes),
                      {stream, std::size_t(cells) + kernel::spare_bytes}};
    const cuda::Array<std::uint8_t> one(stream, 2 * std::size_t(cells)), other(stream, 2 * std::size_t(cells));

    HostArrays arrays;
    volume.add_to(arrays);
    arrays.add(is_visible.before);
    cuda::Views views(stream, std::move(arrays));
    kernel::CellValueRanges ranges{volume.cells.low.data(), volume.cells.high.data(), is_visible.view};
    views.to_device_pointers(ranges.low, ranges.high, ranges.is_visible.before);

    const kernel::OccupancyPass to_one{other.data(), one.data(), cells}, to_other{one.data(), other.data(), cells};
    auto* codes = reinterpret_cast<std::uint8_t*>(made.on_gpu.data());
    kernel::begin_occupancy(stream, ranges, to_one);
    kernel::spread_occupancy(stream, to_other, 1, nx);
    kernel::spread_occupancy(stream, to_one, row, ny);
    kernel::spread_occupancy(stream, to_other, slice, nz);
    made.on_gpu.zero();  // the spare bytes
    kernel::write_occupancy(stream, to_one, codes);
    stream.download(made.codes.data(), codes, made.codes.size());
    stream.wait();
    return made;
}

}  // namespace chiaro
