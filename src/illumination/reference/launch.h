// Rays in one direction from a column of nodes, compiled once per instruction set.
#pragma once
#include <chiaro/device.h>

#include "illumination/reference/kernel.h"

namespace chiaro::kernel {

template <class Rays>
using ColumnFunction = void (*)(const RayKernel<Rays>&, const NodeColumn&);

// Defined in launch.cpp, one namespace per instruction set.
#define CHIARO_DECLARE(isa)                                       \
    namespace isa {                                               \
    template <class Rays>                                         \
    void trace_column(const RayKernel<Rays>&, const NodeColumn&); \
    }
CHIARO_DECLARE(scalar)
CHIARO_DECLARE(x86_64_v2)
CHIARO_DECLARE(x86_64_v3)
CHIARO_DECLARE(x86_64_v4)
#undef CHIARO_DECLARE

template <class Rays>
ColumnFunction<Rays> trace_column_for(Isa isa) {
    constexpr ColumnFunction<Rays> functions[] = {scalar::trace_column<Rays>, x86_64_v2::trace_column<Rays>,
                                                  x86_64_v3::trace_column<Rays>, x86_64_v4::trace_column<Rays>};
    return functions[int(isa)];
}

}  // namespace chiaro::kernel
