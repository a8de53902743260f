// Rays in one direction from a column of nodes, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/reference/harmonics.h"

namespace chiaro::kernel {

template <class Rays>
using ColumnFunction = void (*)(const RayKernel<Rays>&, const NodeColumn&);

template <class Rays>
using RunsFunction = void (*)(const HarmonicsKernel<Rays>&, const NodeRun*, std::int32_t, HarmonicSums*);

#define CHIARO_DECLARE(isa)                                                                     \
    namespace isa {                                                                             \
    template <class Rays>                                                                       \
    void trace_column(const RayKernel<Rays>&, const NodeColumn&);                               \
    template <class Rays>                                                                       \
    void trace_runs(const HarmonicsKernel<Rays>&, const NodeRun*, std::int32_t, HarmonicSums*); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

template <class Rays>
ColumnFunction<Rays> trace_column_for(Isa isa) {
    return CHIARO_PICK(isa, trace_column<Rays>);
}
template <class Rays>
RunsFunction<Rays> trace_runs_for(Isa isa) {
    return CHIARO_PICK(isa, trace_runs<Rays>);
}

}  // namespace chiaro::kernel
