// What each launch_*.cpp compiles: the path tracer through one kind of matter.
#pragma once
#include "pathtrace/kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Kernel>
std::int64_t trace_tile(const Kernel& kernel, const PathTask& task) {
    return sum(kernel.template operator()<NativeLanes>(task));
}

#define CHIARO_INSTANTIATE(Matter)                                                               \
    template std::int64_t trace_tile(const PathKernel<Matter<std::uint8_t>>&, const PathTask&);  \
    template std::int64_t trace_tile(const PathKernel<Matter<std::uint16_t>>&, const PathTask&); \
    template std::int64_t trace_tile(const PathKernel<Matter<float>>&, const PathTask&);

}  // namespace chiaro::kernel::CHIARO_ISA
