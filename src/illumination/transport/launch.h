// The kernels of transport, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/transport/functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(TransportFunctions, transport_functions)

}  // namespace chiaro::kernel
