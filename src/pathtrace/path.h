// What a lane knows of the path that it follows.
#pragma once
#include "kernel/math.h"
#include "kernel/random.h"
#include "raycast/lattice.h"

namespace chiaro::kernel {

/// What a path waits for. Each turn of the loop every lane goes one step on in whatever it is at.
enum Stage : std::int32_t {
    travelling,  ///< on a straight way, towards what it may meet
    met,         ///< at something that may be a collision
    collided,    ///< scattered
    escaped,     ///< at the end of the way, nothing having stopped it
    turning,     ///< to choose the next direction
    ended,       ///< its light is known
    idle         ///< there are no more paths
};

inline constexpr float on_floor = 2;  ///< Path::on_surface

/// Light that is scattered into a direction, and the density with which the direction is drawn; all per steradian.
template <class F>
struct Scattered {
    F coloured;  ///< takes the colour of the matter
    F shine;     ///< has that of the light: a highlight's
    F density;
};

/// Light travels in straight ways between collisions; so does the question whether a light can be seen.
template <class F>
struct Path {
    Int<F> stage{idle};
    Int<F> number{0};  ///< in the queue
    RandomKey<F> key{Int<F>(0), Int<F>(0)};
    Int<F> dimension{0};

    Int<F> scatterings{0};
    Vec3<F> throughput{F(0), F(0), F(0)};  ///< share of the light from ahead that reaches the eye
    Vec3<F> light{F(0), F(0), F(0)};       ///< that has reached it
    Vec3<F> place{F(0), F(0), F(0)};       ///< of the last collision, voxels
    Vec3<F> heading{F(0), F(0), F(1)};     ///< unit, world: away from the eye
    Vec3<F> normal{F(0), F(0), F(0)};      ///< of surfaces: unit, world, on the side the path comes from
    F on_surface{0};                       ///< the last collision: 0 a particle, 1 a surface, 2 the floor
    F shining{0};        ///< of surfaces: ρ(n·v), the share of directions that are drawn from the highlight
    F density{0};        ///< with which the heading was drawn, per steradian
    Int<F> material{0};  ///< entry in the tables of colours
    Vec3<F> colour{F(1), F(1), F(1)};

    // The way it is on.
    Vec3<F> origin{F(0), F(0), F(0)}, direction{F(1), F(1), F(1)};  ///< voxels, voxels per mm
    Vec3<F> inverse{F(1), F(1), F(1)};                              ///< mm per voxel
    F t{0}, end{0};                                                 ///< mm
    F leave{0}, majorant{0};  ///< of the region it is in: where it ends, the largest extinction in it per mm
    F depth{0};               ///< optical depth to the next tentative collision; of surfaces the value here
    Int<F> surface{0};        ///< of surfaces: which is crossed ahead

    F held{0};  ///< > 0: it leaves a skin, which does not dim it until this depth of release is used up

    // A way to the light, on which nothing is scattered.
    Int<F> to_light{0};               ///< 1: it is one
    F transmittance{1};               ///< of it so far
    Vec3<F> offer{F(0), F(0), F(0)};  ///< what arrives if it is clear
};

template <class F>
CHIARO_INLINE Mask<F> at_stage(const Path<F>& path, Stage stage) {
    return path.stage == Int<F>(stage);
}

template <class F>
CHIARO_INLINE Vec3<F> scaled(Vec3<F> a, Vec3<F> b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// Three numbers for the lanes that are set.
template <class F>
CHIARO_INLINE Draw<F> draw_for(Mask<F> lanes, Path<F>& path) {
    const Draw<F> numbers = draw(path.key, path.dimension);
    path.dimension += select(lanes, Int<F>(1), Int<F>(0));
    return numbers;
}

/// -ln u: an optical depth drawn from exp(-τ).
template <class F>
CHIARO_INLINE F free_depth(F u) {
    return F(-0.6931471806f) * log2(u);
}

}  // namespace chiaro::kernel
