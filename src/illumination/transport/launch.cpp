#include "illumination/transport/functions.h"

#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {

TransportFunctions transport_functions() {
    return {
        [](const FirstSweepKernel& kernel, const FirstSweepRow& row) { kernel.operator()<NativeLanes>(row); },
        [](const SourceSweepKernel& kernel, const SourceRow& row) { kernel.operator()<NativeLanes>(row); },
        [](const UpdateKernel& kernel, const UpdateRow& row) { kernel.operator()<NativeLanes>(row); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA
