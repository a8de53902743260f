#include "kernel/launch.h"
#include "illumination/floor/light_kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

void light_floor_points(const FloorLightKernel& kernel, const FloorPoints& points, std::int64_t first,
                        std::int64_t end) {
    for (; first < end; first += LaneTraits<NativeLanes>::count) light_floor<NativeLanes>(kernel, points, first);
}

}  // namespace chiaro::kernel::CHIARO_ISA
