// Three components per lane.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// The same for all lanes.
struct Float3 {
    float x, y, z;
};

template <class F>
struct Vec3 {
    F x, y, z;
    Vec3() = default;
    CHIARO_INLINE Vec3(F x_, F y_, F z_) : x(x_), y(y_), z(z_) {}
    CHIARO_INLINE Vec3(Float3 v) : x(v.x), y(v.y), z(v.z) {}
};

template <class F>
CHIARO_INLINE Vec3<F> operator+(Vec3<F> a, Vec3<F> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
CHIARO_INLINE Vec3<F> operator-(Vec3<F> a, Vec3<F> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
CHIARO_INLINE Vec3<F> operator*(F s, Vec3<F> a) {
    return {s * a.x, s * a.y, s * a.z};
}
/// s * a + b
template <class F>
CHIARO_INLINE Vec3<F> mad(F s, Vec3<F> a, Vec3<F> b) {
    return {mad(s, a.x, b.x), mad(s, a.y, b.y), mad(s, a.z, b.z)};
}
template <class F>
CHIARO_INLINE F dot(Vec3<F> a, Vec3<F> b) {
    return mad(a.x, b.x, mad(a.y, b.y, a.z * b.z));
}

template <class F>
CHIARO_INLINE Vec3<F> select(Mask<F> m, Vec3<F> a, Vec3<F> b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

}  // namespace chiaro::kernel
