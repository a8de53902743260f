// Labels in a march through one channel: samples are taken as without them, then cut and tinted.
#pragma once
#include "raycast/matter.h"

namespace chiaro::kernel {

/// What labels leave of samples. Where they leave a part it is found from extinction, for a step's opacity may have
/// lost in rounding how dense matter is.
template <class F, class Matter>
CHIARO_NOINLINE void cut_by_labels(const Matter& matter, const Location<F>& at, bool additive, const Mask<F>& visible,
                                   F value, RgbaLanes<F>& colour, F& alpha) {
    const F left = left_of(matter.labels, at);
    const Mask<F> partly = visible & (left < F(1));
    if (!any(partly)) return;
    const StepOfMatter step{matter.step.mm, 2e30f};  // albedos are limited when all is mixed
    const RgbaLanes<F> rest =
        step.template of<F>(scale(matter.volume.mixture.channels->matter.at(value), left), additive);
    colour = accumulate(scale(colour, select(partly, F(0), F(1))), select(partly, F(1), F(0)), rest);
    alpha = select(partly, alpha_of(rest), alpha);
}

/// The gradient of extinction, where all lanes are far from borders without looking for these.
template <class F, class Matter>
CHIARO_INLINE Vec3<F> gradient_by_labels(const Matter& matter, const Location<F>& at, Mask<F> near_borders, F value) {
    if (any(near_borders)) return matter.volume.gradient(at);
    const auto& channel = *matter.volume.mixture.channels;
    return gather_float(channel.rise, channel.matter.index(value)) * channel.volume.own_gradient(at);
}

/// Colours of samples as labels tint them.
template <class F, class Matter>
CHIARO_INLINE void tint_by_labels(const Matter& matter, const Location<F>& at, const CellTint<F>& cells,
                                  Mask<F> visible, RgbaLanes<F>& colour, F alpha) {
    if (matter.labels.tint) {
        if (any(visible & cells.several))
            colour = tinted(matter.labels, at, colour);
        else
            colour = cells.tint.of(colour);
    }
    colour = matter.step.template limited<F>(colour, colour, F(1) / max(alpha, F(1e-30f)));
}

}  // namespace chiaro::kernel
