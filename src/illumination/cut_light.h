// Light on cuts through solid matter. What is kept of a volume is convex (clips are half spaces), so nothing lies
// before a cut: all the light of the hemisphere arrives.
#pragma once
#include "illumination/view.h"
#include "kernel/gather.h"

namespace chiaro::kernel {

struct CutLight {
    float rgb[3 * cuts];  ///< E of each

    /// Of the samples that lie on one.
    template <class F>
    CHIARO_INLINE void shine_on(F cut, Vec3<F>& e) const {
        const Mask<F> on = cut >= F(0);
        if (!any(on)) return;
        const Int<F> first = truncate(max(cut, F(0))) * Int<F>(3);
        e = {select(on, gather_float(rgb, first), e.x), select(on, gather_float(rgb + 1, first), e.y),
             select(on, gather_float(rgb + 2, first), e.z)};
    }
};

}  // namespace chiaro::kernel
