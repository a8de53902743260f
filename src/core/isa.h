// One function for each instruction set that kernels are compiled for (cmake/kernels.cmake), and the choice among them.
#pragma once
#include <chiaro/device.h>

#if __has_include("core/kernels_built.h")
// Of this build: CHIARO_FOR_EACH_ISA writes declare(scalar, ...) declare(x86_64_v3, ...) ...
#include "core/kernels_built.h"
#else  // units of kernels, which define some and choose none
#define CHIARO_BUILT_ISAS \
    { true, true, true, true, true }
#define CHIARO_FOR_EACH_ISA(declare, ...)                                                           \
    declare(scalar __VA_OPT__(, ) __VA_ARGS__) declare(x86_64_v2 __VA_OPT__(, ) __VA_ARGS__)        \
        declare(x86_64_v3 __VA_OPT__(, ) __VA_ARGS__) declare(x86_64_v4 __VA_OPT__(, ) __VA_ARGS__) \
            declare(x86_64_v4_gather __VA_OPT__(, ) __VA_ARGS__)
#endif

namespace chiaro::kernel {

template <class Function>
Function pick(Isa isa, Function scalar, Function v2, Function v3, Function v4, Function v4_gather) {
    const Function functions[] = {scalar, v2, v3, v4, v4_gather};
    return functions[int(isa)];
}
/// The function of that name that goes with `isa`.
#define CHIARO_PICK(isa, ...)                                                                                  \
    pick(isa, &scalar::__VA_ARGS__, &x86_64_v2::__VA_ARGS__, &x86_64_v3::__VA_ARGS__, &x86_64_v4::__VA_ARGS__, \
         &x86_64_v4_gather::__VA_ARGS__)

/// Declares `Table name()` of every instruction set, a struct of functions, and `name_for(isa)`.
#define CHIARO_KERNEL_TABLE(Table, name)                   \
    CHIARO_FOR_EACH_ISA(CHIARO_DECLARE_TABLE, Table, name) \
    inline Table name##_for(Isa isa) { return CHIARO_PICK(isa, name)(); }
#define CHIARO_DECLARE_TABLE(isa, Table, name) \
    namespace isa {                            \
    Table name();                              \
    }

}  // namespace chiaro::kernel
