// The path tracer's kernel, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "pathtrace/kernel.h"

namespace chiaro::kernel {

template <class Kernel>
using PathFunction = std::int64_t (*)(const Kernel&, const PathTask&);

#define CHIARO_DECLARE(isa)                                  \
    namespace isa {                                          \
    template <class Kernel>                                  \
    std::int64_t trace_tile(const Kernel&, const PathTask&); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

template <class Kernel>
PathFunction<Kernel> trace_tile_for(Isa isa) {
    return CHIARO_PICK(isa, trace_tile<Kernel>);
}

}  // namespace chiaro::kernel
