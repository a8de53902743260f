// Emission and absorption along a ray (Max 1995; CS 247): one loop for every classification and order.
#pragma once
#include <type_traits>

#include "raycast/composite.h"
#include "raycast/label_march.h"
#include "raycast/matter.h"
#include "raycast/refinement.h"

namespace chiaro::kernel {

enum class Classification : std::int32_t { post, pre, preintegrated };

/// How a volume is marched through: the usual way, known when compiling, and any other.
struct CommonMarch {
    static constexpr Classification classification = Classification::post;
    static constexpr bool backwards = false, additive = false, by_gradient = false, mixed = false, by_block = false,
                          labelled = false;
    static constexpr bool may_be_labelled = false;
};
/// The same with labels in the channel.
struct LabelledMarch : CommonMarch {
    static constexpr bool labelled = true, may_be_labelled = true;
};
struct MarchOptions {
    static constexpr bool may_be_labelled = true;
    Classification classification;
    bool backwards, additive;
    bool by_gradient;  ///< opacity is, too
    bool mixed;        ///< of several channels
    bool labelled;     ///< one channel in which labels lie
    bool by_block;     ///< of the lattice's steps only `Lattice::own` count
    template <class Common>
    CHIARO_INLINE bool is(Common common) const {
        return classification == common.classification && backwards == common.backwards &&
               additive == common.additive && by_gradient == common.by_gradient && mixed == common.mixed &&
               labelled == common.labelled && by_block == common.by_block;
    }
};

/// The value at the end of a pre-integrated step, kept for the next one.
template <class F>
struct EndValue {
    F value{0};
    F steps{-1};  ///< where it was read
};

/// What a ray keeps of a sample for the next ones.
template <class F>
struct Kept {
    EndValue<F> end;
    MetSurface<F> met;
    Refinement<F> refinement;  ///< where there is light
    bool was_lit = false;      ///< the next one's gradient will be asked for
};

/// What is classified: a point, or a step by the values at its ends.
template <class F>
struct Classified {
    RgbaLanes<F> colour;
    F value;  ///< of mixtures none
};

/// A step between its two ends, in steps from the entry.
template <class F, class Matter>
CHIARO_INLINE Classified<F> classify_step(const Matter& matter, const Lattice<F>& lattice, bool backwards,
                                          Mask<F> sampled, const Step<F>& step, EndValue<F>& known) {
    const F exit = lattice.exit(), far_end = min(step.k + step.length, exit), here = backwards ? far_end : step.k,
            there = backwards ? step.k : far_end;
    const Mask<F> unknown = sampled & (known.steps != here);
    F before = known.value;
    if (any(unknown)) before = select(unknown, matter.value_at(matter.volume.clamp(lattice.at(here))), before);
    const F after = matter.value_at(matter.volume.clamp(lattice.at(there)));
    known = {select(sampled, after, known.value), select(sampled, there, known.steps)};
    const F near = backwards ? after : before, far = backwards ? before : after;
    return {matter.segments.between(near, far, matter.table), F(0.5f) * (near + far)};
}

/// Opacity of a share of a step's extinction, as of its last, shorter step: 1 - (1 - α)^share; of what adds up α share.
template <class F>
CHIARO_INLINE void take_share(F share, bool additive, Mask<F> lanes, RgbaLanes<F>& colour, F& alpha) {
    if (!any(lanes)) return;
    const F less = additive ? alpha * share : F(1) - pow(max(F(1) - alpha, F(0)), share);
    const F ratio = select(lanes, less / max(alpha, F(1e-30f)), F(1));
    colour = scale(colour, ratio);
    alpha = alpha * ratio;
}

/// A step's, of several channels.
template <class F, class Matter, class Way, class At>
CHIARO_INLINE RgbaLanes<F> mixed_colour(const Matter& matter, Way way, const At& at) {
    if (way.classification != Classification::pre)
        return matter.step.template of<F>(matter.volume.matter_at(at), way.additive);
    EightMatters<F> eight;
    matter.volume.matter_around(at, eight);
    return matter.step.template interpolated<F>(eight, at.t);
}

/// Of steps with samples at `at`: those across which colours change so much that they are to be taken again in parts.
/// What is found of the gradient serves their light.
template <class F, class Matter, class At>
CHIARO_INLINE Mask<F> find_refined(const Matter& matter, bool mixed, const Lattice<F>& lattice, const Step<F>& step,
                                   const At& at, Mask<F> sampled, Mask<F> visible, F value, F alpha, F transmittance,
                                   Vec3<F>& gradient, bool& has_gradient, Refinement<F>& refinement, F& next) {
    F onset = alpha, within(0);
    if (!mixed) {
        onset = select(visible, matter.onsets.of(matter.table, value), F(0));
        if (matter.asks_normals() && any(visible & !refinement.on)) {
            if (!has_gradient) gradient = matter.volume.gradient(at), has_gradient = true;
            const F half = F(0.5f) * dot(gradient, lattice.step);
            within = select(visible, matter.onsets.change(matter.table, value, half), F(0));
        }
    }
    return refinement.again(sampled & (step.k < lattice.full), step.j, onset, within, transmittance, next);
}

/// Takes the sample in the middle of a step, in voxel coordinates at p, or finds that the step is to be refined:
/// `next`. Where the last one was lit its value comes with its gradient.
template <class F, class Matter, class Way, class Ray>
CHIARO_INLINE void take_sample(const Matter& matter, Way way, const Lattice<F>& lattice, const Cut<F>& cut,
                               Mask<F> sampled, const Step<F>& step, F cut_end, Vec3<F> p, VoxelIndex<F> voxel,
                               const CellTint<F>& tints, const typename Matter::template Held<F>& held, Kept<F>& kept,
                               F& next, Ray& ray) {
    const F k = step.k;
    const bool by_ends = way.classification == Classification::preintegrated;
    Classified<F> c;
    if (by_ends) {
        c = classify_step(matter, lattice, way.backwards, sampled, step, kept.end);
        p = matter.volume.clamp(lattice.middle(k, step.length)), voxel = matter.volume.voxel(p);
    }
    const auto at = by_ends ? matter.volume.locate(p, voxel) : matter.locate(p, voxel, held);
    constexpr bool finds_both = std::is_same_v<Way, CommonMarch> && requires { matter.volume.is_plain(); };
    Vec3<F> gradient;
    bool has_gradient = false;
    if (way.mixed) {
        c = {mixed_colour<F>(matter, way, at), F(0)};
    } else {
        if constexpr (finds_both)
            if (kept.was_lit) gradient = matter.volume.differences(at, c.value), has_gradient = true;
        if (!by_ends && !has_gradient) c.value = matter.volume.value(at);
        if (way.classification == Classification::post) c.colour = matter.table.at(c.value);
        if (way.classification == Classification::pre)
            c.colour = matter.table.interpolated(matter.volume.corners(at), at.t);
    }

    F alpha = select(sampled, alpha_of(c.colour), F(0));
    Mask<F> visible = alpha > F(0);
    if constexpr (finds_both) kept.was_lit = false;
    if (way.by_gradient && any(visible)) {
        gradient = matter.volume.gradient(at), has_gradient = true;
        take_share(matter.volume.factor_of(c.value, gradient), way.additive, visible, c.colour, alpha);
        visible = alpha > F(0);
    }
    constexpr bool may_be_labelled = Way::may_be_labelled && requires { matter.volume.mixture; };
    if constexpr (may_be_labelled) {
        if (way.labelled && matter.labels.cuts()) {
            const Mask<F> near_borders = visible & tints.several;
            if (any(near_borders)) cut_by_labels(matter, at, way.additive, visible, c.value, c.colour, alpha);
            visible = alpha > F(0);
            if (any(visible) && matter.asks_normals())
                gradient = gradient_by_labels(matter, at, near_borders, c.value), has_gradient = true;
        }
    }
    if constexpr (Matter::modulates) {
        if (matter.refines) {
            const Mask<F> again = find_refined(matter, way.mixed, lattice, step, at, sampled, visible, c.value, alpha,
                                               ray.transmittance, gradient, has_gradient, kept.refinement, next);
            sampled = sampled & !again;
            visible = visible & sampled;
        }
    }
    RgbaLanes<F> emission;
    bool emits = false;
    if constexpr (Matter::adds_opacity) {
        if ((emits = matter.field.emits)) {
            emission = matter.field.emission(p, alpha);
            visible = visible | (sampled & (alpha_of(emission) > F(0)));
        }
    }
    if (!any(visible)) return;
    const Cut<F> solid{cut.normal, Mask<F>(sampled & (k < cut_end)), cut.number};
    SamplePoint<F> sample{p, c.value};
    sample.solid = matter.solid.of(alpha);
    Mask<F> is_part = k >= lattice.full;
    F share = lattice.rest;
    if constexpr (Matter::modulates) {
        share = select(is_part, share, step.length);
        is_part = is_part | kept.refinement.on;
    }
    take_share(share, way.additive, visible & is_part, c.colour, alpha);
    if constexpr (may_be_labelled)
        if (way.labelled) tint_by_labels(matter, at, tints, visible, c.colour, alpha);
    if constexpr (finds_both) kept.was_lit = matter.asks_normals() && matter.volume.is_plain();
    matter.light(at, solid, visible, {lattice, k, way.backwards, has_gradient ? &gradient : nullptr}, kept.met, sample,
                 c.colour);
    if (emits) {
        F glow = alpha_of(emission);
        take_share(share, way.additive, visible & is_part, emission, glow);
        c.colour = accumulate(c.colour, F(1), emission);
        alpha = alpha + glow;
    }
    if (way.by_block) {
        F whole = k;
        if constexpr (Matter::modulates) whole = kept.refinement.whole_step(step, way.backwards);
        visible = visible & (whole >= lattice.own.near) & (whole < lattice.own.far);
    }
    ray.reach(visible, p);
    if (way.additive)
        ray.add_emission(visible, c.colour);
    else
        ray.add(way.backwards, visible, c.colour, alpha);
}

/// How many steps behind a cut lie in matter that is solid from there on: they have the plane's normal and its light.
template <class F, class Matter>
CHIARO_NOINLINE F solid_behind(const Matter& matter, const Lattice<F>& lattice, Mask<F> open) {
    constexpr float nothing = 1e-3f;  // of the light passes; what follows is not seen
    F steps(0), passes(1);
    while (any(open)) {
        const F alpha = matter.alpha_at(matter.volume.clamp(lattice.position(steps)));
        open = open & (alpha > F(matter.cut_alpha));
        passes = passes * (F(1) - alpha);
        steps = steps + select(open, F(1), F(0));
        open = open & (passes > F(nothing)) & (steps < lattice.end);
    }
    return steps;
}

/// Marches through the lattice's steps in either order, and hands the ray what it meets; j counts them as they are met,
/// and is no whole number where a step is refined.
/// A pre-integrated step is empty where it lies in an empty cube as a whole, so it starts at its end, any other where
/// its sample is.
template <class F, class Matter, class Way, class Ray>
CHIARO_INLINE Int<F> march_volume(const Matter& matter, Way way, const Lattice<F>& lattice, const Cut<F>& cut,
                                  Mask<F> alive, Ray& ray) {
    const bool by_ends = way.classification == Classification::preintegrated;
    constexpr bool refines = Matter::modulates;
    F j = lattice.first, leave(0);
    F cut_end(0);
    if (const Mask<F> open = alive & cut.open; any(open)) cut_end = solid_behind(matter, lattice, open);
    Kept<F> kept;
    CellTint<F> tints;
    typename Matter::template Held<F> held;
    Int<F> samples(0);
    while (any(alive)) {
        F length(1);
        if constexpr (refines) length = kept.refinement.length();
        const F k = way.backwards ? lattice.first + lattice.end - length - j : j;
        const F end = way.backwards ? min(k + length, lattice.exit()) : k;
        const Vec3<F> p = matter.volume.clamp(by_ends ? lattice.at(end) : lattice.middle(k, length));
        const VoxelIndex<F> voxel = matter.volume.voxel(p);
        F next = j + length;
        Mask<F> sampled = alive;
        if (matter.skip_empty) {
            Mask<F> lost = alive & (j >= leave);
            if constexpr (refines) lost = lost | (alive & kept.refinement.on);
            if (any(lost)) {
                Mask<F> empty = matter.skip_empty_cells(lattice, lost, p, voxel, by_ends ? j : next, next, leave, held);
                if (by_ends) empty = empty & (next > j), next = max(next, j + F(1));
                if constexpr (refines) {
                    next = select(kept.refinement.on, j + length, next);
                    leave = select(kept.refinement.on, F(0), leave);
                    if (matter.refines)
                        kept.refinement.again(empty & (k < lattice.full), j, F(0), F(0), ray.transmittance, next);
                }
                sampled = alive & !empty;
                if constexpr (Way::may_be_labelled)
                    if (way.labelled) tints.enter(matter.labels, lost & sampled, matter.occupancy.index(voxel));
                if (!any(sampled)) {
                    if constexpr (refines) kept.refinement.go_on(next);
                    j = next;
                    alive &= j < lattice.end;
                    continue;
                }
            }
        }
        samples += select(sampled, Int<F>(1), Int<F>(0));
        take_sample(matter, way, lattice, cut, sampled, {j, k, length}, cut_end, p, voxel, tints, held, kept, next,
                    ray);
        if constexpr (refines) kept.refinement.go_on(next);
        j = next;
        alive &= (j < lattice.end) & (ray.transmittance > F(matter.cutoff));
    }
    return samples;
}

/// As any way; apart, so that the usual one keeps its registers.
template <class F, class Matter, class Way, class Ray>
CHIARO_NOINLINE Int<F> march_apart(const Matter& matter, const Way& way, const Lattice<F>& lattice, const Cut<F>& cut,
                                   const Mask<F>& alive, Ray& ray) {
    return march_volume(matter, way, way.backwards ? lattice.reversed() : lattice, cut, alive, ray);
}

}  // namespace chiaro::kernel
