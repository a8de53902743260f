// Where the samples of a lit ray stand closer.
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

/// A step, or a part of one: what of the ray it is.
template <class F>
struct Step {
    F j;       ///< of those that are met, where it begins
    F k;       ///< steps from the entry to its nearer end
    F length;  ///< steps
};

/// A step across which colours change much is taken again in parts, and with it the second half of an empty one before
/// it: skins are often thinner than a step, and were what is seen of one, and of its light, that of one sample, it
/// would go by where in the skin that happens to lie, which shows as rings. What is empty has onset 0 (OnsetTableView),
/// whether it was sampled or skipped.
template <class F>
struct Refinement {
    static constexpr float part = 0.25f;
    /// Of what reaches the eye. Tuned on samples and scans lit by ambient occlusion (docs/theory/light.md): differences
    /// from pictures of an eighth of a step are .2 to .7 of what they are without, of 1.4 to 1.7 times the samples.
    static constexpr float least_change = 0.01f;

    Mask<F> on = F(0) > F(1);
    F onset{0};  ///< in the middle of the last whole step
    F step{-1};  ///< the one that is taken in parts

    CHIARO_INLINE F length() const { return select(on, F(part), F(1)); }

    /// Of steps j, in the middle of which is the onset `here`, which changes by `within` towards their ends: the whole
    /// ones that are to be taken again. `next` becomes where their parts begin.
    CHIARO_INLINE Mask<F> again(Mask<F> steps, F j, F here, F within, F transmittance, F& next) {
        const Mask<F> whole = steps & !on;
        const F change = max(within, abs(here - onset));
        const Mask<F> again = whole & (j > F(0)) & (transmittance * change > F(least_change));
        const Mask<F> from_middle = (onset <= F(least_change)) & (step != j - F(1));
        next = select(again, select(from_middle, j - F(0.5f), j), next);
        onset = select(whole, here, onset);
        step = select(again, j, step);
        on = on | again;
        return again;
    }
    CHIARO_INLINE void go_on(F next) { on = on & (next < step + F(1)); }

    /// Steps from the entry to the whole step that a part belongs to; of any other step to itself.
    CHIARO_INLINE F whole_step(const Step<F>& at, bool backwards) const {
        const F since = at.j - step;
        return select(on, backwards ? at.k + since - (F(1) - at.length) : at.k - since, at.k);
    }
};

}  // namespace chiaro::kernel
