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

/// A step across which colours change much is taken again in parts, and with it the second half of a nearly empty one
/// before it: skins are often thinner than a step, and were what is seen of one, and of its light, that of one sample,
/// it would go by where in the skin that happens to lie, which shows as rings. What is empty has onset 0
/// (OnsetTableView), whether it was sampled or skipped.
template <class F>
struct Refinement {
    /// Of what reaches the eye; more than which makes halves, and quarters. Tuned on samples and scans lit by ambient
    /// occlusion and visibility (docs/theory/light.md): differences from pictures of an eighth of a step are .2 to .7
    /// of what they are without, of 1.3 to 1.6 times the samples. Quarters alone take 1.04 to 1.15 times as long and
    /// differ by .99 times as much (visibility .88 to .96); halves alone take .90 times as long and differ by up to 1.3
    /// (1.5).
    static constexpr float least_change = 0.01f, large_change = 0.05f;

    Mask<F> on = F(0) > F(1);
    F onset{0};  ///< in the middle of the last whole step
    F step{-1};  ///< the one that is taken in parts ...
    F part{1};   ///< ... so long

    CHIARO_INLINE F length() const { return select(on, part, F(1)); }

    /// Of steps j, in the middle of which is the onset `here`, which changes by `within` towards their ends: the whole
    /// ones that are to be taken again. `next` becomes where their parts begin.
    CHIARO_INLINE Mask<F> again(Mask<F> steps, F j, F here, F within, F transmittance, F& next) {
        const Mask<F> whole = steps & !on;
        const F change = transmittance * max(within, abs(here - onset));
        const Mask<F> again = whole & (j > F(0)) & (change > F(least_change));
        const Mask<F> from_middle = (onset <= F(least_change)) & (step != j - F(1));
        next = select(again, select(from_middle, j - F(0.5f), j), next);
        onset = select(whole, here, onset);
        step = select(again, j, step);
        part = select(again, select(change > F(large_change), F(0.25f), F(0.5f)), part);
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
