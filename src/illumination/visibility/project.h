// Projecting what arrives from many directions on spherical harmonics: V_lm += Σ V(ω) w Y_lm(ω).
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// Nodes whose sums are kept in registers together, so that a direction's harmonics are loaded once for all.
inline constexpr std::int32_t project_together = 4;

/// w Y_lm of a batch of directions, w = 4π / N.
struct Harmonics {
    static constexpr std::int32_t width = 16;
    const float* of_direction;  ///< [direction][width]
    const float* sum;           ///< [width]: where all the light arrives
    std::int32_t directions, coefficients;

    CHIARO_INLINE void add_all(float* field) const {
        for (std::int32_t c = 0; c < coefficients; ++c) field[c] += sum[c];
    }

    /// Adds to the fields of `count` nodes what their directions see; `stride` from one direction to the next.
    template <class F, std::int32_t count>
    CHIARO_INLINE void project(const float* const* visibility, std::int32_t stride, float* const* field) const {
        for (std::int32_t c = 0; c < width; c += LaneTraits<F>::count) {
            if (c >= coefficients) return;
            project_at<F, count>(c, visibility, stride, field);
        }
    }
    /// Of coefficient c and those beside it that F holds.
    template <class F, std::int32_t count>
    CHIARO_INLINE void project_at(std::int32_t c, const float* const* visibility, std::int32_t stride,
                                  float* const* field) const {
        F sums[count];
        for (std::int32_t n = 0; n < count; ++n) sums[n] = F(0);
        for (std::int32_t d = 0; d < directions; ++d) {
            const F y = load_row<F>(of_direction + d * width + c);
            for (std::int32_t n = 0; n < count; ++n) sums[n] = mad(F(visibility[n][d * stride]), y, sums[n]);
        }
        for (std::int32_t n = 0; n < count; ++n) add(sums[n], field[n] + c);
    }

private:
    template <class F>
    CHIARO_INLINE void add(F sums, float* field) const {
        if (LaneTraits<F>::count == 1 || coefficients == width) {
            store_row(field, load_row<F>(field) + sums);
            return;
        }
        float lanes[width];
        store_row(lanes, sums);
        for (std::int32_t c = 0; c < coefficients; ++c) field[c] += lanes[c];
    }
};

/// Collects nodes until there are enough to be projected together.
struct Projection {
    const Harmonics& harmonics;
    std::int32_t count = 0, stride = 1;
    const float* visibility[project_together] = {};
    float* field[project_together] = {};

    template <class F>
    CHIARO_INLINE void add(const float* seen, std::int32_t direction_stride, float* to) {
        visibility[count] = seen, field[count] = to, stride = direction_stride;
        if (++count < project_together) return;
        harmonics.template project<F, project_together>(visibility, stride, field);
        count = 0;
    }
    template <class F>
    CHIARO_INLINE void flush() {
        for (std::int32_t n = 0; n < count; ++n) harmonics.template project<F, 1>(visibility + n, stride, field + n);
        count = 0;
    }
};

}  // namespace chiaro::kernel
