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
    std::int32_t back[4];     ///< the four cells, as bits of OpaqueCell::around
    /// [pattern][axis]: Σ |cos| × what a ray weighs, of those that count.
    float open[patterns][3];

    CHIARO_INLINE std::int32_t pattern(std::uint32_t around) const {
        std::uint32_t clear = 0;
        for (std::int32_t tap = 0; tap < 4; ++tap) clear |= (around >> back[tap] & 1) << tap;
        return std::int32_t(clear);
    }
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
    std::uint32_t around;  ///< bit 13 + dx + 3 dy + 9 dz: the cell there is clear
};

/// The opaque cells of a row. Such a cell takes light on each of its open faces and answers on them: `emission`
/// [octant][id][4] is what a ray from that octant finds there; `arriving` [id][face][4] collects Σ cos I and, last,
/// Σ cos of the light on faces +x, -x, +y ...
struct OpaqueRow {
    const OpaqueCell* cells;
    std::int32_t count;
    std::int32_t shown,
        listed;  ///< how many ids; those from `shown` on have no face in the open, on which light arrives
    const float* emission;
    float* arriving;

    CHIARO_INLINE const float* seen_from(const OctantRays& rays, std::int32_t id) const {
        return emission + (std::int64_t(rays.octant) * listed + id) * 4;
    }
};

/// The three faces of opaque cells that look to an octant.
struct FacesTowards {
    float* first[3];

    CHIARO_INLINE FacesTowards(const OpaqueRow& row, const OctantRays& rays) {
        for (std::int32_t axis = 0; axis < 3; ++axis)
            first[axis] = row.arriving + 4 * (2 * axis + (rays.octant >> axis & 1));
    }
    /// `light` [axis][4]: of three channels; the fourth is Σ cos, `open`.
    CHIARO_INLINE void add(OpaqueCell cell, const float* light, const float (&open)[3]) const {
        for (std::int32_t axis = 0; axis < 3; ++axis) {
            float* face = first[axis] + std::int64_t(cell.id) * 24;
            const float added[4]{light[4 * axis], light[4 * axis + 1], light[4 * axis + 2], open[axis]};
            float sums[4];
            for (std::int32_t c = 0; c < 4; ++c) sums[c] = face[c] + added[c];
            for (std::int32_t c = 0; c < 4; ++c) face[c] = sums[c];
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

/// The four cells one plane back, and what each weighs.
template <class F>
struct FourBefore {
    std::int32_t offset[4];
    F weight[4];

    CHIARO_INLINE explicit FourBefore(const SweepRay& ray) {
        for (std::int32_t tap = 0; tap < 4; ++tap) offset[tap] = ray.offset[tap], weight[tap] = F(ray.weight[tap]);
    }
    /// Σ w I.
    CHIARO_INLINE F light(const float* before) const {
        F sum = load_row<F>(before + offset[0]) * weight[0];
        for (std::int32_t tap = 1; tap < 4; ++tap) sum = mad(load_row<F>(before + offset[tap]), weight[tap], sum);
        return sum;
    }
};

/// Packs of sixteen cells that are taken together, so that what belongs to a ray is read once for both; where a pack
/// is two vectors it is already.
template <class F>
CHIARO_INLINE constexpr std::int32_t packs_together() {
    return LaneTraits<F>::count == 16 && !requires(F f) { f.lo; }
    ? 2 : 1;
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
        constexpr std::int32_t packs = packs_together<F>();
        std::int32_t u = 0;
        for (; packs > 1 && u + width < row.count; u += packs * width)
            take<F, packs>(row, u, is_occupied<F>(row.extinction + u) || is_occupied<F>(row.extinction + u + width));
        for (; u < row.count; u += width) {
            const bool matter = is_occupied<F>(row.extinction + u);
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) take<F, 1>(row, u + lane, matter);
        }
        for (std::int32_t o = 0; o < octant_count && row.opaque.count > 0; ++o)
            meet<F>(row, row.opaque.cells, row.opaque.count, octants[o]);
        for (std::int32_t r = 0; r < count; ++r) plane.here[r * plane.field + row.first + row.count] = 1;
    }
    /// One cell, as a thread of a GPU takes it; its id is below 0 where it is not opaque.
    CHIARO_INLINE void at(const FirstSweepRow& row, OpaqueCell cell) const {
        take<float, 1>(row, cell.u, is_occupied<float>(row.extinction + cell.u / width * width));
        for (std::int32_t o = 0; cell.id >= 0 && o < octant_count; ++o) meet<float>(row, &cell, 1, octants[o]);
    }

private:
    template <class F, std::int32_t packs>
    CHIARO_INLINE void take(const FirstSweepRow& row, std::int32_t u, bool matter) const {
        if (matter)
            pass<F, packs, true>(row, u);
        else
            pass<F, packs, false>(row, u);
    }
    /// Where there is no matter T is 1, so that it makes no difference whether it is found.
    template <class F, std::int32_t packs, bool matter>
    CHIARO_INLINE void pass(const FirstSweepRow& row, std::int32_t u) const {
        F extinction[packs], j[packs][sums];
        for (std::int32_t p = 0; p < packs; ++p) {
            extinction[p] = load_row<F>(row.extinction + u + p * width);
            for (std::int32_t s = 0; s < sums; ++s)
                j[p][s] = is_first ? F(0) : load_row<F>(row.sums[s] + u + p * width);
        }
        const float* before = plane.before + row.first + u;
        float* here = plane.here + row.first + u;
        const float* shares = basis;
        const std::int32_t ray_count = count;
        const std::int64_t field = plane.field;
        for (std::int32_t r = 0; r < ray_count; ++r, before += field, here += field, shares += 8) {
            const FourBefore<F> four(rays[r]);
            F in[packs], out[packs];
            for (std::int32_t p = 0; p < packs; ++p) {
                in[p] = four.light(before + p * width);
                F left = in[p];
                if constexpr (matter) left = left * exp2_of_step(extinction[p] * F(rays[r].edges));
                out[p] = left + F(no_light);
            }
            for (std::int32_t p = 0; p < packs; ++p) {
                store_row(here + p * width, out[p]);
                in[p] = in[p] + out[p];
            }
            for (std::int32_t s = 0; s < sums; ++s) {
                const F share(shares[s]);
                for (std::int32_t p = 0; p < packs; ++p) j[p][s] = mad(in[p], share, j[p][s]);
            }
        }
        for (std::int32_t p = 0; p < packs; ++p)
            for (std::int32_t s = 0; s < sums; ++s) store_row(row.sums[s] + u + p * width, j[p][s]);
    }
    /// No light comes from opaque cells: what arrived at these is what the clear ones sent.
    template <class F>
    CHIARO_INLINE void meet(const FirstSweepRow& row, const OpaqueCell* cells, std::int32_t cell_count,
                            const OctantRays& from) const {
        const FacesTowards faces(row.opaque, from);
        const std::int32_t first = from.first, end = from.end, shown = row.opaque.shown;
        const std::int64_t field = plane.field;
        float* const here_first = plane.here + row.first;
        for (std::int32_t i = 0; i < cell_count; ++i) {
            const OpaqueCell cell = cells[i];
            float* here = here_first + cell.u;
            const std::int32_t pattern = from.pattern(cell.around);
            if (pattern != 0 && cell.id < shown) {
                float light[width];
                for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) {
                    F sum(0);
                    for (std::int32_t r = first; r < end; ++r) {
                        const float in = here[r * field] * per_share[pattern * max_rays + r];
                        sum = mad(F(in), load_row<F>(on_faces + r * width + lane), sum);
                    }
                    store_row(light + lane, sum);
                }
                faces.add(cell, light, from.open[pattern]);
            }
            for (std::int32_t r = first; r < end; ++r) here[r * field] = 0;
        }
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
        constexpr std::int32_t packs = packs_together<F>();
        for (std::int32_t u = 0; u < row.count;) {
            const bool matter = is_occupied<F>(row.extinction + u);
            if (packs > 1 && u + width < row.count && is_occupied<F>(row.extinction + u + width) == matter) {
                take<F, packs>(row, u, matter);
                u += packs * width;
                continue;
            }
            for (std::int32_t lane = 0; lane < width; lane += LaneTraits<F>::count) take<F, 1>(row, u + lane, matter);
            u += width;
        }
        for (std::int32_t o = 0; o < octant_count && row.opaque.count > 0; ++o)
            meet(row, row.opaque.cells, row.opaque.count, octants[o]);
        for (std::int32_t p = 0; p < count * channels; ++p) plane.here[p * plane.field + row.first + row.count] = 0;
    }
    /// One cell, as a thread of a GPU takes it; its id is below 0 where it is not opaque.
    CHIARO_INLINE void at(const SourceRow& row, OpaqueCell cell) const {
        take<float, 1>(row, cell.u, is_occupied<float>(row.extinction + cell.u / width * width));
        for (std::int32_t o = 0; cell.id >= 0 && o < octant_count; ++o) meet(row, &cell, 1, octants[o]);
    }

private:
    template <class F, std::int32_t packs>
    CHIARO_INLINE void take(const SourceRow& row, std::int32_t u, bool matter) const {
        if (matter)
            pass<F, packs, true>(row, u);
        else
            pass<F, packs, false>(row, u);
    }
    template <class F, std::int32_t packs, bool matter>
    CHIARO_INLINE void pass(const SourceRow& row, std::int32_t u) const {
        F extinction[packs], source[packs][channels], j[packs][sums];
        for (std::int32_t p = 0; p < packs; ++p) {
            if constexpr (matter) {
                extinction[p] = load_row<F>(row.extinction + u + p * width);
                for (std::int32_t c = 0; c < channels; ++c)
                    source[p][c] = load_row<F>(row.source[c] + u + p * width) + F(no_light);
            }
            for (std::int32_t s = 0; s < sums; ++s) j[p][s] = F(0);
        }
        const float* before = plane.before + row.first + u;
        float* here = plane.here + row.first + u;
        const std::int32_t ray_count = count;
        const std::int64_t field = plane.field;
        for (std::int32_t r = 0; r < ray_count; ++r) {
            const FourBefore<F> four(rays[r]);
            F clear[packs], bright[packs];
            if constexpr (matter)
                for (std::int32_t p = 0; p < packs; ++p) clear[p] = exp2_of_step(extinction[p] * F(rays[r].edges));
            for (std::int32_t c = 0; c < channels; ++c, before += field, here += field) {
                F in[packs], out[packs];
                for (std::int32_t p = 0; p < packs; ++p) {
                    in[p] = four.light(before + p * width);
                    if constexpr (matter)
                        out[p] = mad(clear[p], in[p] - source[p][c], source[p][c]);
                    else
                        out[p] = in[p] + F(no_light);
                }
                for (std::int32_t p = 0; p < packs; ++p) {
                    store_row(here + p * width, out[p]);
                    const F both = in[p] + out[p];
                    j[p][c] = j[p][c] + both;
                    bright[p] = c == 0 ? F(luminance[0]) * both : mad(F(luminance[c]), both, bright[p]);
                }
            }
            for (std::int32_t axis = 0; axis < 2; ++axis) {
                const F along(cosine[cosines * r + 3 + axis]);
                for (std::int32_t p = 0; p < packs; ++p)
                    j[p][channels + axis] = mad(along, bright[p], j[p][channels + axis]);
            }
        }
        for (std::int32_t p = 0; p < packs; ++p)
            for (std::int32_t s = 0; s < sums; ++s) add(row.sums[s] + u + p * width, j[p][s]);
    }
    template <class F>
    CHIARO_INLINE void add(float* to, F sum) const {
        sum = sum * F(weight);
        store_row(to, is_first ? sum : sum + load_row<F>(to));
    }
    /// Only light from clear cells arrives: opaque ones beside these may shine on the other side of a wall.
    CHIARO_INLINE void meet(const SourceRow& row, const OpaqueCell* cells, std::int32_t cell_count,
                            const OctantRays& from) const {
        const FacesTowards faces(row.opaque, from);
        const std::int32_t first = from.first, end = from.end, shown = row.opaque.shown;
        const std::int64_t field = plane.field, ray = channels * field;
        const std::int64_t start = first * ray + row.first;
        const float* const emission = row.opaque.seen_from(from, 0);
        for (std::int32_t i = 0; i < cell_count; ++i) {
            const OpaqueCell cell = cells[i];
            const std::int32_t pattern = from.pattern(cell.around);
            const float* seen = emission + std::int64_t(cell.id) * 4;
            const float red = seen[0], green = seen[1], blue = seen[2];
            float* here = plane.here + start + cell.u;
            if (pattern != 0 && cell.id < shown) {
                float light[12]{};
                const float* before = plane.before + start + cell.u;
                const float* at = here;
                for (std::int32_t r = first; r < end; ++r, before += ray, at += ray)
                    arrive(r, pattern, before, at, light);
                faces.add(cell, light, from.open[pattern]);
            }
            for (std::int32_t r = first; r < end; ++r, here += ray)
                here[0] = red, here[field] = green, here[2 * field] = blue;
        }
    }
    CHIARO_INLINE void arrive(std::int32_t r, std::int32_t pattern, const float* before, const float* here,
                              float (&light)[12]) const {
        const float* weights = open_weight + (r * OctantRays::patterns + pattern) * 4;
        for (std::int32_t c = 0; c < channels; ++c, before += plane.field, here += plane.field) {
            float in = *here;
            if (pattern != OctantRays::patterns - 1) {
                in = before[rays[r].offset[0]] * weights[0];
                for (std::int32_t tap = 1; tap < 4; ++tap) in = mad(before[rays[r].offset[tap]], weights[tap], in);
            }
            for (std::int32_t axis = 0; axis < 3; ++axis)
                light[4 * axis + c] = mad(in, cosine[cosines * r + axis], light[4 * axis + c]);
        }
    }
};

}  // namespace chiaro::kernel
