// Isosurfaces: the crossings of a few values along a ray, nearest or farthest first.
#pragma once
#include "raycast/composite.h"
#include "raycast/matter.h"

namespace chiaro::kernel {

/// Surfaces of one value each, in stored units, ascending; colours premultiplied.
struct SurfacesView {
    static constexpr int most = 8;
    float values[most];
    Rgba colours[most];
    std::int32_t count;
    bool backwards;
    float outside;  ///< a value beyond all of them, on the side of what they do not hold
};

/// The value at a place; outside where labels hide it.
template <class F, class Matter, class At>
CHIARO_INLINE F shown_value(const Matter& matter, const SurfacesView& surfaces, const At& at) {
    const F value = matter.volume.value(at);
    if constexpr (requires { matter.volume.mixture; })
        return shown_value(matter.labels, at, value, surfaces.outside);
    else
        return value;
}
template <class F, class Matter>
CHIARO_INLINE F shown_value(const Matter& matter, const SurfacesView& surfaces, Vec3<F> p) {
    p = matter.volume.clamp(p);
    return shown_value<F>(matter, surfaces, matter.volume.locate(p, matter.volume.voxel(p)));
}

/// A piece of a ray, in steps, and the values at its ends.
template <class F>
struct Piece {
    F near, far;
    F value_near, value_far;
};

/// The colour of a surface as labels tint it; albedos are limited after that.
template <class F, class Matter>
CHIARO_INLINE void tint_surface(const Matter& matter, const Location<F>& at, F alpha, RgbaLanes<F>& colour) {
    if (matter.labels.tint) colour = tinted(matter.labels, at, colour);
    colour = matter.step.template limited<F>(colour, colour, F(1) / max(alpha, F(1e-30f)));
}

template <class F, class Matter, class Ray>
CHIARO_NOINLINE void show_surface(const Matter& matter, const SurfacesView& surfaces, std::int32_t i, Vec3<F> p,
                                  const Lattice<F>& lattice, const Cut<F>& cut, const Mask<F>& hit, Ray& ray) {
    p = matter.volume.clamp(p);
    const auto at = matter.volume.locate(p, matter.volume.voxel(p));
    RgbaLanes<F> colour = load_rgba(surfaces.colours, Int<F>(i));
    Vec3<F> gradient;
    bool is_labelled = false;
    if constexpr (requires { matter.volume.mixture; }) {
        if ((is_labelled = matter.labels.cells)) {
            gradient = surface_gradient(matter.labels, at, matter.volume.value(at) - F(surfaces.values[i]),
                                        matter.volume.gradient(at), surfaces.outside);
            tint_surface<F>(matter, at, F(surfaces.colours[i].a), colour);
        }
    }
    MetSurface<F> none;
    matter.light(at, cut, hit, {lattice, F(0), false, is_labelled ? &gradient : nullptr}, none,
                 {p, F(surfaces.values[i])}, colour);
    ray.reach(hit, p);
    ray.add(surfaces.backwards, hit, colour, F(surfaces.colours[i].a));
}

/// Where a ray enters a cut inside a surface, the surface lies in the plane.
template <class F, class Matter, class Ray>
CHIARO_INLINE void show_cut(const Matter& matter, const SurfacesView& surfaces, const Lattice<F>& lattice,
                            const Cut<F>& cut, Mask<F> alive, Ray& ray) {
    Mask<F> open = alive & cut.open;
    if (!any(open)) return;
    const F value = shown_value(matter, surfaces, lattice.entry);
    for (std::int32_t i = surfaces.count - 1; i >= 0; --i) {
        const Mask<F> inside = open & (value >= F(surfaces.values[i]));
        if (any(inside)) show_surface(matter, surfaces, i, lattice.entry, lattice, cut, inside, ray);
        open = open & !inside;
    }
}

/// Composites surface i where it is crossed in the piece: bisected to 1/128 of a step, then linear. The values at the
/// ends are read again, for behind a skip only their side of the surface is known.
template <class F, class Matter, class Ray>
CHIARO_INLINE void cross(const Matter& matter, const SurfacesView& surfaces, std::int32_t i, const Lattice<F>& lattice,
                         Mask<F> alive, Piece<F> piece, Ray& ray) {
    const F surface(surfaces.values[i]);
    const Mask<F> below = piece.value_near < surface;
    const Mask<F> crossed = alive & ((below & (piece.value_far >= surface)) | ((!below) & (piece.value_far < surface)));
    if (!any(crossed)) return;
    const auto value_at = [&](F steps)
                              CHIARO_INLINE_LAMBDA { return shown_value(matter, surfaces, lattice.at(steps)); };
    piece = {piece.near, piece.far, value_at(piece.near), value_at(piece.far)};
    for (int halving = 0; halving < 7; ++halving) {
        const F middle = F(0.5f) * (piece.near + piece.far), between = value_at(middle);
        const Mask<F> same = (below & (between < surface)) | ((!below) & (between >= surface));
        piece = {select(same, middle, piece.near), select(same, piece.far, middle),
                 select(same, between, piece.value_near), select(same, piece.value_far, between)};
    }
    const F rise = piece.value_far - piece.value_near;
    const F share =
        select(abs(rise) > F(0), (surface - piece.value_near) / select(abs(rise) > F(0), rise, F(1)), F(0.5f));
    const Cut<F> none{Vec3<F>(F(0), F(0), F(0)), F(0) > F(1), F(-1)};
    show_surface(matter, surfaces, i, lattice.at(lerp(piece.near, piece.far, share)), lattice, none, crossed, ray);
}

/// All crossings in the piece: where values rise along the ray the lowest surface is the nearest, else the highest.
template <class F, class Matter, class Ray>
CHIARO_INLINE void cross_all(const Matter& matter, const SurfacesView& surfaces, const Lattice<F>& lattice,
                             Mask<F> alive, const Piece<F>& piece, Ray& ray) {
    for (std::int32_t n = 0; n < 2 * surfaces.count; ++n) {
        const bool rising = n < surfaces.count;
        const std::int32_t up = rising ? n : n - surfaces.count;
        const std::int32_t i = rising != surfaces.backwards ? up : surfaces.count - 1 - up;
        const Mask<F> lanes = rising ? piece.value_near < piece.value_far : piece.value_near > piece.value_far;
        cross(matter, surfaces, i, lattice, alive & lanes, piece, ray);
    }
}

/// Piece m ends at sample m, the last at the exit; the first begins at the entry. In an empty cube all values lie on
/// one side of every surface, so behind it the side is still known.
template <class F, class Matter, class Ray>
CHIARO_NOINLINE Int<F> march_to_surfaces(const Matter& matter, const SurfacesView& surfaces, Lattice<F> lattice,
                                         const Cut<F>& cut, Mask<F> alive, Ray& ray) {
    const bool backwards = surfaces.backwards;
    const F exit = lattice.exit(), pieces = min(floor(exit + F(0.5f)), lattice.end) + F(1);
    if (backwards) lattice = lattice.reversed();
    if (!backwards) show_cut(matter, surfaces, lattice, cut, alive, ray);
    const Mask<F> seen = alive;
    alive &= lattice.first < pieces;
    typename Matter::template Held<F> held;
    F j = lattice.first, leave(0);
    F before = shown_value(matter, surfaces, backwards ? lattice.at(exit) : lattice.entry);
    Int<F> samples = select(alive, Int<F>(1), Int<F>(0));
    while (any(alive)) {
        const F m = backwards ? lattice.first + pieces - F(1) - j : j;
        Piece<F> piece{max(m - F(0.5f), F(0)), min(m + F(0.5f), exit), before, before};
        const Vec3<F> p = matter.volume.clamp(lattice.at(backwards ? piece.near : piece.far));
        const VoxelIndex<F> voxel = matter.volume.voxel(p);
        const F value = shown_value<F>(matter, surfaces, matter.volume.locate(p, voxel));
        (backwards ? piece.value_near : piece.value_far) = value;
        samples += select(alive, Int<F>(1), Int<F>(0));
        cross_all(matter, surfaces, lattice, alive, piece, ray);
        before = value;
        F next = j + F(1);
        const Mask<F> lost = alive & (j >= leave);
        if (matter.skip_empty && any(lost)) matter.skip_empty_cells(lattice, lost, p, voxel, next, next, leave, held);
        alive &= (next < pieces) & (ray.transmittance > F(matter.cutoff));
        j = next;
    }
    if (backwards) show_cut(matter, surfaces, lattice, cut, seen, ray);
    return samples;
}

}  // namespace chiaro::kernel
