// The kernels of transport, by instruction set.
#pragma once
#include "illumination/transport/sweep_kernel.h"
#include "illumination/transport/update_kernel.h"

namespace chiaro::kernel {

struct TransportFunctions {
    void (*first_row)(const FirstSweepKernel&, const FirstSweepRow&);
    void (*source_row)(const SourceSweepKernel&, const SourceRow&);
    void (*update_row)(const UpdateKernel&, const UpdateRow&);
};

}  // namespace chiaro::kernel
