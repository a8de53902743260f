// The share of a cell's answer that looks outwards only, by its normal n = -(α(i + 1) - α(i - 1)) per axis.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// min(1, 4 F |n|): a step of a quarter of the opacity between the neighbours is a surface. (With F |n| soft matter,
/// whose normals are .1 to .5, was answered mostly as if it had none.)
template <class F>
CHIARO_INLINE F outward_share(Vec3<F> n, float normal_factor) {
    return min(F(4 * normal_factor) * sqrt(dot(n, n)), F(1));
}

}  // namespace chiaro::kernel
