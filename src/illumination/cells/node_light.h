// Light of three colours at the nodes of a grid, and a fourth number, as the ray caster looks it up.
#pragma once
#include "illumination/cells/place.h"
#include "kernel/half.h"

namespace chiaro::kernel {

struct NodeLight {
    const Light16* nodes;  ///< [node][4]; x fastest
    GridView grid;
    Float3 scale;  ///< of the colours

    template <class F>
    struct Place {
        typename GatherIndex<F>::type index;
        Vec3<F> t;
    };
    template <class F>
    CHIARO_INLINE Place<F> locate(Vec3<F> p_voxel) const {
        const GridLocation<F> at = grid.locate(p_voxel);
        return {typename GatherIndex<F>::type(at.node * Int<F>(4)), at.t};
    }

    /// Trilinear, of this light.
    template <class F>
    CHIARO_INLINE Vec3<F> at(Vec3<F> p_voxel) const {
        const Place<F> place = locate(p_voxel);
        const Two<F> rg = pair(nodes, place), b = pair(nodes + 2, place);
        return {rg.a * F(scale.x), rg.b * F(scale.y), b.a * F(scale.z)};
    }

    /// Trilinear, unscaled, of any four numbers a node.
    template <class F>
    CHIARO_INLINE Four<F> four(const Light16* of, const Place<F>& place) const {
        const Two<F> ab = pair(of, place), cd = pair(of + 2, place);
        return {ab.a, ab.b, cd.a, cd.b};
    }

private:
    template <class F>
    CHIARO_INLINE Two<F> pair(const Light16* of, const Place<F>& place) const {
        const Distances rows = grid.rows(4);
        const auto near = gather_two(of, place.index, rows), far = gather_two(of + 4, place.index, rows);
        return {trilinear<F>({near.a.a, near.b.a, near.c.a, near.d.a}, {far.a.a, far.b.a, far.c.a, far.d.a}, place.t),
                trilinear<F>({near.a.b, near.b.b, near.c.b, near.d.b}, {far.a.b, far.b.b, far.c.b, far.d.b}, place.t)};
    }
};

}  // namespace chiaro::kernel
