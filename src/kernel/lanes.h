// The lane types that kernels are written over. `F` is float (one pixel: the scalar build and a CUDA thread) or Lanes
// (sixteen pixels in lock step). What differs between pixels is F, Int<F> or Mask<F>; what is the same for all is
// plain. This header holds the scalar side and picks the SIMD side.
#pragma once
#include <cmath>
#include <cstdint>

#ifdef __CUDACC__
#define CHIARO_INLINE __host__ __device__ __forceinline__
#define CHIARO_INLINE_LAMBDA
#define CHIARO_NOINLINE __host__ __device__ inline
#else
#define CHIARO_INLINE inline __attribute__((always_inline))
#define CHIARO_INLINE_LAMBDA __attribute__((always_inline))  // lambdas in kernels must be forced too
#define CHIARO_NOINLINE __attribute__((noinline))            // what is rare, kept out of the way of what is not
#endif

namespace chiaro::kernel {

template <class F>
struct LaneTraits;
template <>
struct LaneTraits<float> {
    using Int = std::int32_t;
    using Mask = bool;
    static constexpr int count = 1;
};
template <class F>
using Int = typename LaneTraits<F>::Int;
template <class F>
using Mask = typename LaneTraits<F>::Mask;

CHIARO_INLINE bool any(bool m) { return m; }
CHIARO_INLINE int count(bool m) { return m; }
CHIARO_INLINE float select(bool m, float a, float b) { return m ? a : b; }
CHIARO_INLINE std::int32_t select(bool m, std::int32_t a, std::int32_t b) { return m ? a : b; }
/// b, but 0 where a < limit.
CHIARO_INLINE float zero_below(float a, float limit, float b) { return a < limit ? 0 : b; }
CHIARO_INLINE float min(float a, float b) { return a < b ? a : b; }
CHIARO_INLINE float max(float a, float b) { return a > b ? a : b; }
CHIARO_INLINE std::int32_t min(std::int32_t a, std::int32_t b) { return a < b ? a : b; }
CHIARO_INLINE std::int32_t max(std::int32_t a, std::int32_t b) { return a > b ? a : b; }
CHIARO_INLINE float sqrt(float a) { return ::sqrtf(a); }
CHIARO_INLINE float abs(float a) { return a < 0 ? -a : a; }
/// Largest integer <= a, as a float.
CHIARO_INLINE float floor(float a) { return ::floorf(a); }
CHIARO_INLINE float to_float(std::int32_t a) { return float(a); }
/// Towards zero: the largest integer <= a for a >= 0.
CHIARO_INLINE std::int32_t truncate(float a) { return std::int32_t(a); }

CHIARO_INLINE std::int32_t bits_of(float a) {
    std::int32_t bits;
    __builtin_memcpy(&bits, &a, sizeof bits);
    return bits;
}
CHIARO_INLINE float float_of(std::int32_t bits) {
    float a;
    __builtin_memcpy(&a, &bits, sizeof a);
    return a;
}

/// a * b + c in two roundings, on purpose: so every instruction set gives the same bits, those without fused
/// multiply-add too, and a sample never falls on the other side of a table entry (3 % of a frame).
CHIARO_INLINE float mad(float a, float b, float c) { return a * b + c; }

/// a + t (b - a)
template <class F>
CHIARO_INLINE F lerp(F a, F b, F t) {
    return mad(t, b - a, a);
}

}  // namespace chiaro::kernel

// Kernel units are compiled with CHIARO_ISA set (cmake/kernels.cmake); all other code sees the scalar side alone.
#if defined(CHIARO_ISA) && !defined(CHIARO_ISA_scalar) && !defined(__CUDACC__)
#define CHIARO_SIMD 1
#include "kernel/simd.h"
#endif
