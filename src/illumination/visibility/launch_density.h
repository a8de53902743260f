// Rows of density, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/rows.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(DensityRows, density_rows)

}  // namespace chiaro::kernel
