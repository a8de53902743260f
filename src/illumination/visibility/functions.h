// The kernels of visibility, by instruction set.
#pragma once
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/sheared_kernel.h"
#include "illumination/visibility/sweep_kernel.h"

namespace chiaro::kernel {

struct VisibilityFunctions {
    void (*sweep_row)(const SweepKernel&, const SweepRow&);
    void (*sheared_row)(const ShearedKernel&, const ShearedRow&);
    void (*keep)(const KeepKernel&, std::int64_t first, std::int32_t count);
    void (*add_steps)(const AddSteps&, float* parts, std::int32_t count, std::uint16_t* to, std::int64_t stride);
    void (*light)(const LightKernel&, std::int64_t first, std::int32_t count);
};

}  // namespace chiaro::kernel
