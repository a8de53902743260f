// No illumination method: all light arrives everywhere.
#pragma once
#include "illumination/view.h"

namespace chiaro::kernel {

struct NoneView {
    static constexpr bool modulates = false, adds_opacity = false, by_surface = false;
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        return shading.local(sample);
    }
};

}  // namespace chiaro::kernel
