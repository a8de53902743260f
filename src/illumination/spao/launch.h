// The kernels of SPAO, compiled once per instruction set.
#pragma once
#include <chiaro/device.h>

#include "illumination/spao/functions.h"

namespace chiaro::kernel {

// Defined in launch.cpp.
namespace scalar {
SpaoFunctions spao_functions();
}
namespace x86_64_v2 {
SpaoFunctions spao_functions();
}
namespace x86_64_v3 {
SpaoFunctions spao_functions();
}
namespace x86_64_v4 {
SpaoFunctions spao_functions();
}

inline SpaoFunctions spao_functions_for(Isa isa) {
    switch (isa) {
        case Isa::scalar:
            return scalar::spao_functions();
        case Isa::x86_64_v2:
            return x86_64_v2::spao_functions();
        case Isa::x86_64_v3:
            return x86_64_v3::spao_functions();
        default:
            return x86_64_v4::spao_functions();
    }
}

}  // namespace chiaro::kernel
