// Compositing of associated colours, in either order, or without absorption.
#pragma once
#include "kernel/rgba.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// What a ray has gathered.
template <class F>
struct Composite {
    RgbaLanes<F> sum;
    F transmittance{1};  ///< to the eye; stays 1 from back to front

    CHIARO_INLINE Composite() { zero(sum); }

    /// From front to back: C += T c, T *= 1 - α. `alpha` is the colour's own.
    CHIARO_INLINE void add_behind(Mask<F> where, const RgbaLanes<F>& colour, F alpha) {
        const F weight = select(where, transmittance, F(0));
        sum = accumulate(sum, weight, colour);
        transmittance = transmittance - weight * alpha;
    }

    /// From back to front: C = c + (1 - α) C.
    CHIARO_INLINE void add_in_front(Mask<F> where, const RgbaLanes<F>& colour, F alpha) {
        sum = accumulate(scale(sum, select(where, F(1) - alpha, F(1))), select(where, F(1), F(0)), colour);
    }

    /// In either order, where nothing hides anything: C += c.
    CHIARO_INLINE void add_emission(Mask<F> where, const RgbaLanes<F>& colour) {
        sum = accumulate(sum, select(where, F(1), F(0)), colour);
    }

    /// Hears where the next sample lies, which a colour does not depend on.
    CHIARO_INLINE void reach(Mask<F>, const Vec3<F>&) {}

    CHIARO_INLINE void add(bool backwards, Mask<F> where, const RgbaLanes<F>& colour, F alpha) {
        if (backwards)
            add_in_front(where, colour, alpha);
        else
            add_behind(where, colour, alpha);
    }
};

}  // namespace chiaro::kernel
