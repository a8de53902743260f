// What the transfer function makes of values: of one at a sample, of eight around it, of all between two.
#pragma once
#include "kernel/rgba.h"

namespace chiaro::kernel {

/// Associated colours, corrected to the opacity of one step, over the stored values.
struct StepTableView : RgbaTable {
    /// Classified first: the colours of the eight voxels, interpolated.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> interpolated(const Four<Two<F>>& voxels, Vec3<F> t) const {
        const auto along_x = [&](const Two<F>& v) CHIARO_INLINE_LAMBDA { return mix<F>(at(v.a), at(v.b), t.x); };
        const RgbaLanes<F> low = mix<F>(along_x(voxels.a), along_x(voxels.b), t.y);
        const RgbaLanes<F> high = mix<F>(along_x(voxels.c), along_x(voxels.d), t.y);
        return mix<F>(low, high, t.z);
    }
};

/// How much colours change between a value and the nearest one that shows nothing: where two values differ by much,
/// what lies between them may be seen, whatever either shows.
struct OnsetTableView {
    const float* onsets;  ///< of the step table's entries

    template <class F>
    CHIARO_INLINE F of(const StepTableView& steps, F value) const {
        return gather_float(onsets, steps.index(value));
    }
    /// From the middle of a step, over which the value rises by twice `half`, to either of its ends.
    template <class F>
    CHIARO_INLINE F change(const StepTableView& steps, F value, F half) const {
        const F here = of(steps, value);
        return max(abs(of(steps, value + half) - here), abs(of(steps, value - half) - here));
    }
};

/// Pre-integrated steps over the stored values at their ends (classify/segments.h).
struct SegmentTableView {
    const Rgba* entries;          ///< [value at the near end][value at the far end]
    const float* visible_before;  ///< how many of the step table's entries before each are visible
    float scale, offset;          ///< node = stored * scale + offset
    std::int32_t nodes;           ///< of either value

    /// Bilinear. Where no entry between the two values is visible nothing is, whatever the nodes around them hold: so
    /// skipping empty cells, whose ranges meet wherever the cells do, changes nothing.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> between(F near, F far, const StepTableView& steps) const {
        const F a = node_of(near), b = node_of(far);
        const Int<F> i = node_before(a), j = node_before(b), at = i * Int<F>(nodes) + j;
        const F s = a - to_float(i), t = b - to_float(j);
        const RgbaLanes<F> colour =
            mix<F>(mix<F>(load_rgba(entries, at), load_rgba(entries + 1, at), t),
                   mix<F>(load_rgba(entries + nodes, at), load_rgba(entries + nodes + 1, at), t), s);
        if (!any(alpha_of(colour) > F(0))) return colour;
        const Int<F> p = steps.index(near), q = steps.index(far);
        const F visible = gather_float(visible_before + 1, max(p, q)) - gather_float(visible_before, min(p, q));
        return kernel::scale(colour, min(visible, F(1)));
    }

private:
    template <class F>
    CHIARO_INLINE F node_of(F stored) const {
        return min(max(mad(stored, F(scale), F(offset)), F(0)), F(float(nodes - 1)));
    }
    /// One that another follows.
    template <class F>
    CHIARO_INLINE Int<F> node_before(F node) const {
        return min(truncate(node), Int<F>(nodes - 2));
    }
};

}  // namespace chiaro::kernel
