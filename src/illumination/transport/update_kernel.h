// What follows a sweep of scattered light: J, its running mean, and the source of the next sweep. The item is sixteen
// cells of a row (F = Lanes) or one.
#pragma once
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

struct UpdateRow {
    std::int32_t count;
    const float* extinction;
    const float* albedo[3];
    const float* first[3];  ///< J of uncollided light
    /// Of scattered light that came from +x, -x, +y ...: J, and the first moment of luminance along the minor axes.
    const float* sums[6][5];
    float* source[3];
    float* mean[3];          ///< J, running mean
    float* moment[3][3];     ///< [channel][axis], running mean; scattered light only
    float (*change)[2][16];  ///< Σ (change of the mean)², Σ mean², by lane
};

struct UpdateKernel {
    static constexpr std::int32_t width = 16;
    float edges;       ///< of a step, × -log2 e
    float relaxation;  ///< 0: the source is a J, so that each sweep is one more bounce
    float share;       ///< of this sweep in the running means
    float cosine;      ///< mean, between directions and their major axis
    float luminance[3];

    template <class F>
    CHIARO_INLINE void operator()(const UpdateRow& row) const {
        for (std::int32_t u = 0; u < row.count; u += width)
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) {
                if (u + lane >= row.count) break;
                update<F>(row, u + lane, lane);
            }
    }

private:
    template <class F>
    CHIARO_INLINE void update(const UpdateRow& row, std::int32_t u, std::int32_t lane) const {
        const F clear = exp2_below_0(load_row<F>(row.extinction + u) * F(edges));
        const F own = (F(1) - clear) * F(0.5f);  // of its source a cell sees so much itself
        F change(0), size(0), scattered[3], bright(0);
        for (std::int32_t c = 0; c < 3; ++c) {
            scattered[c] = F(0);
            for (std::int32_t side = 0; side < 6; ++side)
                scattered[c] = scattered[c] + load_row<F>(row.sums[side][c] + u);
            bright = mad(F(luminance[c]), scattered[c], bright);
        }
        const F per_bright = F(1) / max(bright, F(1e-30f));
        for (std::int32_t axis = 0; axis < 3; ++axis) {
            // Where matter is dark, over-relaxed light may be a trace below 0.
            const F of_bright = min(max(minor_moment<F>(row, u, axis) * per_bright, F(-1)), F(1));
            for (std::int32_t c = 0; c < 3; ++c)
                approach(row.moment[c][axis] + u,
                         mad(of_bright, scattered[c],
                             (load_row<F>(row.sums[2 * axis][c] + u) - load_row<F>(row.sums[2 * axis + 1][c] + u)) *
                                 F(cosine)));
        }
        for (std::int32_t c = 0; c < 3; ++c) {
            const F light = load_row<F>(row.first[c] + u) + scattered[c];
            const F step = approach(row.mean[c] + u, light), mean = load_row<F>(row.mean[c] + u);
            change = mad(step, step, change), size = mad(mean, mean, size);
            const F albedo = load_row<F>(row.albedo[c] + u), source = load_row<F>(row.source[c] + u);
            const F next = albedo * light;
            store_row(row.source[c] + u,
                      relaxation > 0 ? mad((next - source) / (F(1) - albedo * own), F(relaxation), source) : next);
        }
        add(row, u, lane, change, (*row.change)[0]);
        add(row, u, lane, size, (*row.change)[1]);
    }
    /// Of luminance along an axis, from the sides to which that is a minor one.
    template <class F>
    CHIARO_INLINE F minor_moment(const UpdateRow& row, std::int32_t u, std::int32_t axis) const {
        F sum(0);
        for (std::int32_t side = 0; side < 6; ++side) {
            const std::int32_t major = side / 2;
            if (major == axis) continue;
            sum = sum + load_row<F>(row.sums[side][3 + (axis > major ? axis - 1 : axis)] + u);
        }
        return sum;
    }
    /// Moves a running mean; returns by how much.
    template <class F>
    CHIARO_INLINE F approach(float* mean, F value) const {
        const F before = load_row<F>(mean), step = (value - before) * F(share);
        store_row(mean, before + step);
        return step;
    }
    /// Only what lies within the row.
    template <class F>
    CHIARO_INLINE void add(const UpdateRow& row, std::int32_t u, std::int32_t lane, F values, float* sums) const {
        float of_lane[width];
        store_row(of_lane, values);
        const std::int32_t inside = min(row.count - u, std::int32_t(LaneTraits<F>::count));
        for (std::int32_t i = 0; i < inside; ++i) sums[lane + i] += of_lane[i];
    }
};

}  // namespace chiaro::kernel
