// Values at rows of cells, and what of these lies inside surfaces, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/cells/row_functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(CellFunctions, cell_functions)

}  // namespace chiaro::kernel
