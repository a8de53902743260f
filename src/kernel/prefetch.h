// Asking for memory before it is needed.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// For what will be written soon.
CHIARO_INLINE void prefetch([[maybe_unused]] void* to) {
#ifndef __CUDA_ARCH__
    __builtin_prefetch(to, 1);
#endif
}

/// For what will be read soon.
CHIARO_INLINE void prefetch_read([[maybe_unused]] const void* from) {
#ifndef __CUDA_ARCH__
    __builtin_prefetch(from);
#endif
}

}  // namespace chiaro::kernel
