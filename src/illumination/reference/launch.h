// Rays in one direction from a column of nodes, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/reference/kernel.h"

namespace chiaro::kernel {

template <class Rays>
using ColumnFunction = void (*)(const RayKernel<Rays>&, const NodeColumn&);

#define CHIARO_DECLARE(isa)                                       \
    namespace isa {                                               \
    template <class Rays>                                         \
    void trace_column(const RayKernel<Rays>&, const NodeColumn&); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

template <class Rays>
ColumnFunction<Rays> trace_column_for(Isa isa) {
    return CHIARO_PICK(isa, trace_column<Rays>);
}

}  // namespace chiaro::kernel
