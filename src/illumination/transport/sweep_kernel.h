// A row of cells in a directional sweep through matter that scatters (docs/theory/transport.md): planes perpendicular
// to the directions' major axis, from the light's side. The item is sixteen cells along the row (F = Lanes) or one.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// A direction, seen from one plane to the next: the point one plane back lies between four cells.
struct SweepRay {
    std::int32_t offset[4];  ///< of these cells from the own one, in a plane
    float weight[4];         ///< bilinear
    float edges;             ///< of a step, × -log2 e
};

/// Rays of a batch that come from one octant lie side by side, between the same four cells. A pattern says which of the
/// four are clear (bit i: the i-th); rays that find less of the open than `least_open` do not count.
struct OctantRays {
    static constexpr std::int32_t patterns = 16;
    std::int32_t first, end;  ///< rays
    std::int32_t octant;      ///< signs of the directions, towards the light: 1: -x, 2: -y, 4: -z
    std::int64_t back[4];     ///< the four cells, in the bytes that say where cells are clear
    /// [pattern][axis]: Σ |cos| × what a ray weighs, of those that count.
    float open[patterns][3];
};

inline constexpr float least_open = 0.1f;

/// What leaves the cells of the plane before and of this one, per ray and channel, with a halo of one that holds what
/// comes from outside.
struct SweepPlane {
    const float* before;
    float* here;
    std::int64_t field;  ///< from one ray's or channel's row to the next
};

/// A cell that lets nothing through and shows something of itself.
struct OpaqueCell {
    std::int32_t u, id;
};

/// The opaque cells of a row. Such a cell takes light on each of its open faces and answers on them: `emission`
/// [octant][id][4] is what a ray from that octant finds there; `arriving` [id][face][4] collects Σ cos I and, last,
/// Σ cos of the light on faces +x, -x, +y ...
struct OpaqueRow {
    const OpaqueCell* cells;
    std::int32_t count;
    std::int32_t shown,
        listed;  ///< how many ids; those from `shown` on have no face in the open, on which light arrives
    const std::uint8_t* clear;  ///< of the row's first cell: 0 where a cell is opaque, else 1
    std::int64_t stride;        ///< from one cell to the next, in `clear`
    const float* emission;
    float* arriving;

    /// Which of the four cells that the rays come from are clear.
    CHIARO_INLINE std::int32_t pattern(const OctantRays& rays, OpaqueCell cell) const {
        const std::uint8_t* own = clear + cell.u * stride;
        return own[rays.back[0]] | own[rays.back[1]] << 1 | own[rays.back[2]] << 2 | own[rays.back[3]] << 3;
    }
    CHIARO_INLINE const float* seen_from(const OctantRays& rays, OpaqueCell cell) const {
        return emission + (std::int64_t(rays.octant) * listed + cell.id) * 4;
    }
    /// `light` [axis][channel], on the three faces that look to the octant.
    CHIARO_INLINE void add(const OctantRays& rays, OpaqueCell cell, const float* light, const float* open) const {
        for (std::int32_t axis = 0; axis < 3; ++axis) {
            float* face = arriving + std::int64_t(cell.id) * 24 + 4 * (2 * axis + (rays.octant >> axis & 1));
            for (std::int32_t c = 0; c < 3; ++c) face[c] = face[c] + light[4 * axis + c];
            face[3] = face[3] + open[axis];
        }
    }
};

/// 2^x for -125 <= x <= 0, relative error below 4e-6 (the best of degree 4 on [-1/2, 1/2]); 1 at 0. The sum with 1.5 ×
/// 2^23 is rounded to a whole number, which its last bits hold.
template <class F>
CHIARO_INLINE F exp2_of_step(F x) {
    const F shifted = x + F(12582912), r = x - (shifted - F(12582912));
    F series = mad(r, F(0.009782912f), F(0.055976883f));
    series = mad(r, series, F(0.24020711f));
    series = mad(r, series, F(0.69311360f));
    series = mad(r, series, F(1));
    return float_of(bits_of(series) + (bits_of(shifted) << Int<F>(23)));
}

/// Σ w I' of the four cells one plane back.
template <class F>
CHIARO_INLINE F light_before(const SweepRay& ray, const float* before) {
    F light = load_row<F>(before + ray.offset[0]) * F(ray.weight[0]);
    for (std::int32_t tap = 1; tap < 4; ++tap)
        light = mad(load_row<F>(before + ray.offset[tap]), F(ray.weight[tap]), light);
    return light;
}

/// Whether any of sixteen cells stops light: decided for all of them, so that every instruction set does the same.
template <class F>
CHIARO_INLINE bool is_occupied(const float* extinction) {
    bool found = false;
    for (std::int32_t lane = 0; lane < 16; lane += LaneTraits<F>::count)
        found |= any(load_row<F>(extinction + lane) > F(0));
    return found;
}

/// Added to what goes on: numbers too small to be normal would take a hundred times as long.
inline constexpr float no_light = 1e-20f;

/// Light that no one has scattered: grey transmittance T of each ray, I = T × the probe's radiance.
struct FirstSweepRow {
    std::int32_t first, count;  ///< place of the first cell in a plane, cells
    const float* extinction;    ///< of a cell's edge, the row padded to sixteen; at most 49
    float* sums[6];             ///< J of three channels and the first moment of luminance
    OpaqueRow opaque;
};
struct FirstSweepKernel {
    static constexpr std::int32_t width = 16, max_rays = 18, sums = 6;
    const SweepRay* rays;
    const float* basis;  ///< [ray][8]: what a ray of T = 1 adds to the sums
    const OctantRays* octants;
    std::int32_t octant_count;
    const float* per_share;  ///< [pattern][max_rays]: 1 / the share of the open, 0 where a ray does not count
    const float* on_faces;   ///< [ray][axis][4], padded to 16: |cos| × the light that a ray of T = 1 brings
    std::int32_t count;
    bool is_first;  ///< sums are written, not added to
    SweepPlane plane;

    template <class F>
    CHIARO_INLINE void operator()(const FirstSweepRow& row) const {
        for (std::int32_t u = 0; u < row.count; u += width) {
            const bool matter = is_occupied<F>(row.extinction + u);
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) take<F>(row, u + lane, matter);
        }
        for (std::int32_t i = 0; i < row.opaque.count; ++i)
            for (std::int32_t o = 0; o < octant_count; ++o) meet<F>(row, row.opaque.cells[i], octants[o]);
        for (std::int32_t r = 0; r < count; ++r) plane.here[r * plane.field + row.first + row.count] = 1;
    }
    /// One cell, as a thread of a GPU takes it; `id` among the opaque ones, below 0: it is none.
    CHIARO_INLINE void at(const FirstSweepRow& row, std::int32_t u, std::int32_t id) const {
        take<float>(row, u, is_occupied<float>(row.extinction + u / width * width));
        for (std::int32_t o = 0; id >= 0 && o < octant_count; ++o) meet<float>(row, {u, id}, octants[o]);
    }

private:
    template <class F>
    CHIARO_INLINE void take(const FirstSweepRow& row, std::int32_t u, bool matter) const {
        float mean[max_rays * LaneTraits<F>::count];
        if (matter)
            pass<F, true>(row, u, mean);
        else
            pass<F, false>(row, u, mean);
        add<F>(row, u, mean);
    }
    template <class F, bool matter>
    CHIARO_INLINE void pass(const FirstSweepRow& row, std::int32_t u, float* mean) const {
        const F extinction = load_row<F>(row.extinction + u);
        for (std::int32_t r = 0; r < count; ++r) {
            const std::int64_t at = r * plane.field + row.first + u;
            const F in = light_before<F>(rays[r], plane.before + at);
            F left = in;
            if constexpr (matter) left = in * exp2_of_step(extinction * F(rays[r].edges));
            const F out = left + F(no_light);
            store_row(plane.here + at, out);
            store_row(mean + r * LaneTraits<F>::count, in + out);
        }
    }
    template <class F>
    CHIARO_INLINE void add(const FirstSweepRow& row, std::int32_t u, const float* mean) const {
        for (std::int32_t s = 0; s < sums; s += 3) {
            F a(0), b(0), c(0);
            if (!is_first)
                a = load_row<F>(row.sums[s] + u), b = load_row<F>(row.sums[s + 1] + u),
                c = load_row<F>(row.sums[s + 2] + u);
            for (std::int32_t r = 0; r < count; ++r) {
                const F light = load_row<F>(mean + r * LaneTraits<F>::count);
                const float* shares = basis + 8 * r + s;
                a = mad(light, F(shares[0]), a), b = mad(light, F(shares[1]), b), c = mad(light, F(shares[2]), c);
            }
            store_row(row.sums[s] + u, a), store_row(row.sums[s + 1] + u, b), store_row(row.sums[s + 2] + u, c);
        }
    }
    /// No light comes from opaque cells: what arrived at this one is what the clear ones sent.
    template <class F>
    CHIARO_INLINE void meet(const FirstSweepRow& row, OpaqueCell cell, const OctantRays& from) const {
        float* here = plane.here + row.first + cell.u;
        const std::int32_t pattern = row.opaque.pattern(from, cell);
        if (pattern != 0 && cell.id < row.opaque.shown) {
            float light[width];
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) {
                F sum(0);
                for (std::int32_t r = from.first; r < from.end; ++r) {
                    const float in = here[r * plane.field] * per_share[pattern * max_rays + r];
                    sum = mad(F(in), load_row<F>(on_faces + r * width + lane), sum);
                }
                store_row(light + lane, sum);
            }
            row.opaque.add(from, cell, light, from.open[pattern]);
        }
        for (std::int32_t r = from.first; r < from.end; ++r) here[r * plane.field] = 0;
    }
};

/// Scattered light: I_out = S + T (I_in - S), S what a cell of infinite depth would send.
struct SourceRow {
    std::int32_t first, count;
    const float* extinction;
    const float* source[3];
    float* sums[5];  ///< Σ (I_in + I_out) weight / 2; of luminance, times the direction along the two minor axes
    OpaqueRow opaque;
};
struct SourceSweepKernel {
    static constexpr std::int32_t width = 16, max_rays = 6, channels = 3, sums = 5, cosines = 5;
    const SweepRay* rays;
    float weight;  ///< of a ray, / 2
    const OctantRays* octants;
    std::int32_t octant_count;
    const float* open_weight;  ///< [ray][pattern][4]: of the clear cells alone; 0 where a ray does not count
    const float* cosine;       ///< [ray][5]: |cos| of the angles with the axes; the direction along the minor ones
    float luminance[channels];
    std::int32_t count;
    bool is_first;  ///< sums are written, not added to
    SweepPlane plane;

    template <class F>
    CHIARO_INLINE void operator()(const SourceRow& row) const {
        for (std::int32_t u = 0; u < row.count; u += width) {
            const bool matter = is_occupied<F>(row.extinction + u);
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) take<F>(row, u + lane, matter);
        }
        for (std::int32_t i = 0; i < row.opaque.count; ++i)
            for (std::int32_t o = 0; o < octant_count; ++o) meet(row, row.opaque.cells[i], octants[o]);
        for (std::int32_t p = 0; p < count * channels; ++p) plane.here[p * plane.field + row.first + row.count] = 0;
    }
    /// One cell, as a thread of a GPU takes it; `id` among the opaque ones, below 0: it is none.
    CHIARO_INLINE void at(const SourceRow& row, std::int32_t u, std::int32_t id) const {
        take<float>(row, u, is_occupied<float>(row.extinction + u / width * width));
        for (std::int32_t o = 0; id >= 0 && o < octant_count; ++o) meet(row, {u, id}, octants[o]);
    }

private:
    template <class F>
    CHIARO_INLINE void take(const SourceRow& row, std::int32_t u, bool matter) const {
        if (matter)
            pass<F, true>(row, u);
        else
            pass<F, false>(row, u);
    }
    template <class F, bool matter>
    CHIARO_INLINE void pass(const SourceRow& row, std::int32_t u) const {
        float clear[max_rays * LaneTraits<F>::count];
        if constexpr (matter) {
            const F extinction = load_row<F>(row.extinction + u);
            for (std::int32_t r = 0; r < count; ++r)
                store_row(clear + r * LaneTraits<F>::count, exp2_of_step(extinction * F(rays[r].edges)));
        }
        F bright[max_rays];
        for (std::int32_t c = 0; c < channels; ++c) {
            const F source = load_row<F>(row.source[c] + u) + F(no_light);
            F sum(0);
            for (std::int32_t r = 0; r < count; ++r) {
                const std::int64_t at = (r * channels + c) * plane.field + row.first + u;
                const F in = light_before<F>(rays[r], plane.before + at);
                F out;
                if constexpr (matter)
                    out = mad(load_row<F>(clear + r * LaneTraits<F>::count), in - source, source);
                else
                    out = in + F(no_light);
                store_row(plane.here + at, out);
                const F both = in + out;
                sum = sum + both;
                bright[r] = c == 0 ? F(luminance[0]) * both : mad(F(luminance[c]), both, bright[r]);
            }
            add(row.sums[c] + u, sum);
        }
        for (std::int32_t axis = 0; axis < 2; ++axis) {
            F sum(0);
            for (std::int32_t r = 0; r < count; ++r) sum = mad(F(cosine[cosines * r + 3 + axis]), bright[r], sum);
            add(row.sums[channels + axis] + u, sum);
        }
    }
    template <class F>
    CHIARO_INLINE void add(float* to, F sum) const {
        sum = sum * F(weight);
        store_row(to, is_first ? sum : sum + load_row<F>(to));
    }
    /// Only light from clear cells arrives: opaque ones beside this one may shine on the other side of a wall.
    CHIARO_INLINE void meet(const SourceRow& row, OpaqueCell cell, const OctantRays& from) const {
        const std::int32_t pattern = row.opaque.pattern(from, cell);
        const float* emission = row.opaque.seen_from(from, cell);
        float light[12]{};
        for (std::int32_t r = from.first; r < from.end; ++r) {
            float* here = plane.here + r * channels * plane.field + row.first + cell.u;
            if (pattern != 0 && cell.id < row.opaque.shown) arrive(row, cell, r, pattern, here, light);
            for (std::int32_t c = 0; c < channels; ++c) here[c * plane.field] = emission[c];
        }
        if (pattern != 0 && cell.id < row.opaque.shown) row.opaque.add(from, cell, light, from.open[pattern]);
    }
    CHIARO_INLINE void arrive(const SourceRow& row, OpaqueCell cell, std::int32_t r, std::int32_t pattern,
                              const float* here, float* light) const {
        const float* before = plane.before + r * channels * plane.field + row.first + cell.u;
        const float* weights = open_weight + (r * OctantRays::patterns + pattern) * 4;
        for (std::int32_t c = 0; c < channels; ++c) {
            float in = here[c * plane.field];
            if (pattern != OctantRays::patterns - 1) {
                in = before[c * plane.field + rays[r].offset[0]] * weights[0];
                for (std::int32_t tap = 1; tap < 4; ++tap)
                    in = mad(before[c * plane.field + rays[r].offset[tap]], weights[tap], in);
            }
            for (std::int32_t axis = 0; axis < 3; ++axis)
                light[4 * axis + c] = mad(in, cosine[cosines * r + axis], light[4 * axis + c]);
        }
    }
};

}  // namespace chiaro::kernel
