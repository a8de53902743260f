// A row of cells in a directional sweep through matter that scatters (illumination.md 5): planes perpendicular to the
// directions' major axis, from the light's side. The item is sixteen cells along the row (F = Lanes) or one.
#pragma once
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// A direction, seen from one plane to the next: the point one plane back lies between four cells.
struct SweepRay {
    std::int32_t offset[4];  ///< of these cells from the own one, in a plane
    float weight[4];         ///< bilinear
    std::int32_t octant;     ///< signs of the direction, towards the light: 1: -x, 2: -y, 4: -z
    std::int64_t back[4];    ///< as `offset`, in the bytes that say where cells are clear
    float cosine[3];         ///< of the direction and the axes
};

/// What leaves the cells of the plane before and of this one, per ray and channel, with a halo of one that holds what
/// comes from outside.
struct SweepPlane {
    const float* before;
    float* here;
    std::int64_t field;  ///< from one ray's or channel's plane to the next
};

/// A cell that lets nothing through and shows something of itself.
struct OpaqueCell {
    std::int32_t u, id;
};

/// The opaque cells of a row. Such a cell takes light on each of its open faces and answers on them: `emission`
/// [id][octant][4] is what a ray from that octant finds there; `arriving` [id][face][4] collects Σ cos I and, last,
/// Σ cos of the light on faces +x, -x, +y ...
struct OpaqueRow {
    const OpaqueCell* cells;
    std::int32_t count;
    const std::uint8_t* clear;  ///< of the row's first cell: 0 where a cell is opaque, else 1
    std::int64_t stride;        ///< from one cell to the next, in `clear`
    const float* emission;
    float* arriving;
};

/// Σ w I' of the four cells one plane back.
template <class F>
CHIARO_INLINE F light_before(const SweepRay& ray, const float* before) {
    F light = load_row<F>(before + ray.offset[0]) * F(ray.weight[0]);
    for (std::int32_t tap = 1; tap < 4; ++tap)
        light = mad(load_row<F>(before + ray.offset[tap]), F(ray.weight[tap]), light);
    return light;
}

/// How much of what a ray finds lies in the open. (An opaque cell beside this one may shine on the other side.)
CHIARO_INLINE float open_share(const SweepRay& ray, const std::uint8_t* clear) {
    float share = 0;
    for (std::int32_t tap = 0; tap < 4; ++tap)
        if (clear[ray.back[tap]]) share = share + ray.weight[tap];
    return share;
}

/// Of the light one plane back, what comes from the open.
CHIARO_INLINE float open_light(const SweepRay& ray, const float* before, const std::uint8_t* clear) {
    float light = 0;
    for (std::int32_t tap = 0; tap < 4; ++tap)
        if (clear[ray.back[tap]]) light = mad(ray.weight[tap], before[ray.offset[tap]], light);
    return light;
}

/// Less than this is none: numbers too small to be normal would take a hundred times as long.
inline constexpr float no_light = 1e-7f;

/// Rays that find less of the open do not count.
inline constexpr float least_open = 0.1f;

/// What arrives on the three faces that a ray meets, `light` of it from the open.
CHIARO_INLINE void arrive(const SweepRay& ray, const float* light, float* arriving) {
    for (std::int32_t axis = 0; axis < 3; ++axis) {
        const float cosine = abs(ray.cosine[axis]);
        float* face = arriving + 4 * (2 * axis + (ray.octant >> axis & 1));
        for (std::int32_t c = 0; c < 4; ++c) face[c] = mad(cosine, light[c], face[c]);
    }
}

/// Light that no one has scattered: grey transmittance T of each ray, I = T × the probe's radiance.
struct FirstSweepRow {
    std::int32_t first, count;  ///< place of the first cell in a plane, cells
    const float* extinction;    ///< of a cell's edge, the row padded to sixteen
    float* sums[6];             ///< J of three channels and the first moment of luminance, to be added to
    OpaqueRow opaque;
};
struct FirstSweepKernel {
    static constexpr std::int32_t width = 16, most_rays = 8, sums = 6;
    const SweepRay* rays;
    const float* edges;  ///< [ray]: of a step, × -log2 e
    const float* basis;  ///< [ray][8]: what a ray of T = 1 adds to the sums
    std::int32_t count;
    SweepPlane plane;

    template <class F>
    CHIARO_INLINE void operator()(const FirstSweepRow& row) const {
        float mean[most_rays * width];
        for (std::int32_t u = 0; u < row.count; u += width) {
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) pass<F>(row, u + lane, mean + lane);
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) add<F>(row, u + lane, mean + lane);
        }
        for (std::int32_t i = 0; i < row.opaque.count; ++i) meet(row, row.opaque.cells[i]);
        for (std::int32_t r = 0; r < count; ++r) plane.here[r * plane.field + row.first + row.count] = 1;
    }

private:
    template <class F>
    CHIARO_INLINE void pass(const FirstSweepRow& row, std::int32_t u, float* mean) const {
        const F extinction = load_row<F>(row.extinction + u);
        for (std::int32_t r = 0; r < count; ++r) {
            const std::int64_t at = r * plane.field + row.first + u;
            const F clear = exp2_below_0(extinction * F(edges[r]));
            const F in = light_before<F>(rays[r], plane.before + at), left = in * clear;
            const F out = select(left < F(no_light), F(0), left);
            store_row(plane.here + at, out);
            store_row(mean + r * width, in + out);
        }
    }
    template <class F>
    CHIARO_INLINE void add(const FirstSweepRow& row, std::int32_t u, const float* mean) const {
        for (std::int32_t s = 0; s < sums; s += 3) {
            F a = load_row<F>(row.sums[s] + u), b = load_row<F>(row.sums[s + 1] + u),
              c = load_row<F>(row.sums[s + 2] + u);
            for (std::int32_t r = 0; r < count; ++r) {
                const F light = load_row<F>(mean + r * width);
                const float* shares = basis + 8 * r + s;
                a = mad(light, F(shares[0]), a), b = mad(light, F(shares[1]), b), c = mad(light, F(shares[2]), c);
            }
            store_row(row.sums[s] + u, a), store_row(row.sums[s + 1] + u, b), store_row(row.sums[s + 2] + u, c);
        }
    }
    CHIARO_INLINE void meet(const FirstSweepRow& row, OpaqueCell cell) const {
        for (std::int32_t r = 0; r < count; ++r) {
            float* here = plane.here + r * plane.field + row.first + cell.u;
            const float share = open_share(rays[r], row.opaque.clear + cell.u * row.opaque.stride);
            if (share >= least_open) {
                const float in = *here / share;
                const float* colour = basis + 8 * r;  // radiance × weight / 2
                const float light[4] = {in * colour[0], in * colour[1], in * colour[2], colour[7]};
                arrive(rays[r], light, row.opaque.arriving + std::int64_t(cell.id) * 24);
            }
            *here = 0;
        }
    }
};

/// Scattered light: I_out = S + T (I_in - S), S what a cell of infinite depth would send. All rays of a sweep have
/// steps of the same length.
struct SourceRow {
    std::int32_t first, count;
    const float* extinction;
    const float* source[3];
    float* sums[3];  ///< Σ (I_in + I_out) weight / 2
    OpaqueRow opaque;
};
struct SourceSweepKernel {
    static constexpr std::int32_t width = 16, most_rays = 6, channels = 3;
    const SweepRay* rays;
    const float* edges;  ///< [ray]: of a step, × -log2 e
    float weight;        ///< of a ray, / 2
    std::int32_t count;
    bool first;  ///< sums are written, not added to
    SweepPlane plane;

    template <class F>
    CHIARO_INLINE void operator()(const SourceRow& row) const {
        for (std::int32_t u = 0; u < row.count; u += width)
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) pass<F>(row, u + lane);
        for (std::int32_t i = 0; i < row.opaque.count; ++i) meet(row, row.opaque.cells[i]);
        for (std::int32_t p = 0; p < count * channels; ++p) plane.here[p * plane.field + row.first + row.count] = 0;
    }

private:
    template <class F>
    CHIARO_INLINE void pass(const SourceRow& row, std::int32_t u) const {
        const F extinction = load_row<F>(row.extinction + u);
        F sums[channels];
        for (std::int32_t c = 0; c < channels; ++c) sums[c] = F(0);
        for (std::int32_t r = 0; r < count; ++r) {
            const F clear = exp2_below_0(extinction * F(edges[r]));
            for (std::int32_t c = 0; c < channels; ++c) {
                const std::int64_t at = (r * channels + c) * plane.field + row.first + u;
                const F in = light_before<F>(rays[r], plane.before + at), source = load_row<F>(row.source[c] + u);
                const F left = mad(clear, in - source, source), out = select(left < F(no_light), F(0), left);
                store_row(plane.here + at, out);
                sums[c] = sums[c] + (in + out);
            }
        }
        for (std::int32_t c = 0; c < channels; ++c) {
            const F sum = sums[c] * F(weight);
            store_row(row.sums[c] + u, first ? sum : sum + load_row<F>(row.sums[c] + u));
        }
    }
    CHIARO_INLINE void meet(const SourceRow& row, OpaqueCell cell) const {
        for (std::int32_t r = 0; r < count; ++r) {
            float* here = plane.here + r * channels * plane.field + row.first + cell.u;
            const float share = open_share(rays[r], row.opaque.clear + cell.u * row.opaque.stride);
            if (share >= least_open) {
                const float* before = plane.before + r * channels * plane.field + row.first + cell.u;
                const std::uint8_t* clear = row.opaque.clear + cell.u * row.opaque.stride;
                const auto from = [&](std::int32_t c) CHIARO_INLINE_LAMBDA {
                    const float in =
                        share > 0.9999f ? here[c * plane.field] : open_light(rays[r], before + c * plane.field, clear);
                    return in / share;
                };
                const float light[4] = {from(0), from(1), from(2), 1};
                arrive(rays[r], light, row.opaque.arriving + std::int64_t(cell.id) * 24);
            }
            const float* emission = row.opaque.emission + (std::int64_t(cell.id) * 8 + rays[r].octant) * 4;
            for (std::int32_t c = 0; c < channels; ++c) here[c * plane.field] = emission[c];
        }
    }
};

}  // namespace chiaro::kernel
