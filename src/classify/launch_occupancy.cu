// Occupancy on GPUs: one thread a cell.
#include "classify/launch_gpu.h"
#include "cuda/launch.h"

namespace chiaro::kernel {
namespace {

struct Begin {
    CellValueRanges ranges;
    OccupancyPass pass;
    CHIARO_DEVICE void operator()(std::int64_t i) const { pass.begin(i, ranges.occupied(i)); }
};
struct Spread {
    OccupancyPass pass;
    std::int64_t stride;
    std::int32_t n;
    CHIARO_DEVICE void operator()(std::int64_t i) const { pass.along(i, stride, n); }
};
struct Write {
    OccupancyPass pass;
    std::uint8_t* codes;
    CHIARO_DEVICE void operator()(std::int64_t i) const { codes[i] = pass.code(i); }
};

}  // namespace

void begin_occupancy(cuda::Stream& stream, const CellValueRanges& ranges, const OccupancyPass& pass) {
    cuda::launch_items(stream, pass.cells, Begin{ranges, pass});
}
void spread_occupancy(cuda::Stream& stream, const OccupancyPass& pass, std::int64_t stride, std::int32_t n) {
    cuda::launch_items(stream, pass.cells, Spread{pass, stride, n});
}
void write_occupancy(cuda::Stream& stream, const OccupancyPass& pass, std::uint8_t* codes) {
    cuda::launch_items(stream, pass.cells, Write{pass, codes});
}

}  // namespace chiaro::kernel
