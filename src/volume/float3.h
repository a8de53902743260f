// From the library's vectors to those of kernels.
#pragma once
#include <chiaro/geometry.h>

#include "kernel/vec.h"

namespace chiaro {

inline kernel::Float3 float3(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }

}  // namespace chiaro
