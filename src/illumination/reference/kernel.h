// One direction for one node (F = float) or for sixteen along x (F = Lanes): how much light comes from there. A node is
// a cell that rays start from. All nodes share the direction, so sixteen neighbours march in lock step.
#pragma once
#include "kernel/math.h"
#include "kernel/row.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// Beyond this optical depth no light is left: exp(-17) = 4e-8, far below the 65535ths that are kept.
inline constexpr float opaque_depth = 17;

/// V = exp(-τ)
template <class F>
CHIARO_INLINE F transmittance(F depth) {
    return select(depth < F(opaque_depth), exp2(depth * F(-1.442695041f)), F(0));
}

template <class F>
CHIARO_INLINE void add_to(double* sums, F lanes) {
    constexpr int count = LaneTraits<F>::count;
    float values[count];
    store_row(values, lanes);
    for (int i = 0; i < count; ++i) sums[i] += double(values[i]);
}

/// How much a direction counts for a node with the outward normal n: for all nodes the same, by the side of n, or by
/// the cosine.
enum class Lobe : std::int32_t { sphere, hemisphere, cosine };

/// Sixteen nodes along x in each row of a block, with what rays have found for them; arrays by z, y and node.
struct NodeColumn {
    static constexpr std::int32_t width = 16;

    std::int32_t x, stride, place;  ///< cell of the first node, cells between two, place of the first in its row
    std::int32_t rows_y, rows_z;
    const std::int32_t *y, *z;                    ///< cells of the rows
    const float* cell_x;                          ///< cells of the sixteen nodes
    const float *normal_x, *normal_y, *normal_z;  ///< n, unit or 0
    const float* share;                           ///< q, how much of the answer looks along n; the rest everywhere
    double *light, *weight;                       ///< Σ w V and Σ w
};

/// A cell that a ray crosses: its distance in memory from the first, and the length of the way through it in edges.
struct Crossing {
    std::int32_t distance;
    float edges;
};

/// Extinction constant in each cell, crossed exactly (Amanatides and Woo 1987). What a ray crosses is the same list for
/// every cell that it may start from; only the part of the list that may are occupied differs.
struct CellRays {
    const float* extinction;  ///< per edge; 0 in the gaps between rows
    std::int32_t row, slice;
    const Crossing* crossings;
    struct Axis {
        const std::int32_t* beyond;  ///< [m]: the first crossing at least m cells away
        bool up;
        std::int32_t low, high, last;  ///< first and last cell of the matter, last cell of all
    } x_axis, y_axis, z_axis;

    template <class F>
    CHIARO_INLINE F depth(const NodeColumn& nodes, std::int32_t lane, std::int32_t y, std::int32_t z, F start) const {
        const std::int32_t x = min(nodes.x + lane * nodes.stride, x_axis.last);  // a column may reach beyond the grid
        Span span{0, 0x7fffffff};
        narrow(span, x_axis, x, min(x + (LaneTraits<F>::count - 1) * nodes.stride, x_axis.last));
        narrow(span, y_axis, y, y);
        narrow(span, z_axis, z, z);
        return march<F>(extinction + std::int64_t(z) * slice + std::int64_t(y) * row + nodes.place + lane, span, start);
    }

private:
    struct Span {
        std::int32_t first, last;
    };

    /// Leaves the crossings at which a ray from one of the cells [from, to] may be within the matter.
    static CHIARO_INLINE void narrow(Span& span, const Axis& axis, std::int32_t from, std::int32_t to) {
        const std::int32_t until_in = axis.up ? axis.low - to : from - axis.high;
        const std::int32_t until_out = axis.up ? axis.high + 1 - from : to - axis.low + 1;
        if (until_in > 0) span.first = max(span.first, axis.beyond[until_in]);
        span.last = min(span.last, until_out > 0 ? axis.beyond[until_out] : 0);
    }

    /// τ = Σ κ × length, in two sums by the crossing's parity, so that one addition need not wait for the last. Where
    /// other lanes begin and end changes nothing: what this lane meets there is empty.
    template <class F>
    CHIARO_INLINE F march(const float* from, Span span, F start) const {
        F even = start, odd = F(0);
        const auto cross = [&](F& sum, std::int32_t k) CHIARO_INLINE_LAMBDA {
            sum = mad(load_row<F>(from + crossings[k].distance), F(crossings[k].edges), sum);
        };
        std::int32_t k = span.first & ~1;
        for (; k + 8 <= span.last; k += 8) {
            cross(even, k), cross(odd, k + 1), cross(even, k + 2), cross(odd, k + 3);
            cross(even, k + 4), cross(odd, k + 5), cross(even, k + 6), cross(odd, k + 7);
            if (!any(even + odd < F(opaque_depth))) return even + odd;
        }
        for (; k + 2 <= span.last; k += 2) cross(even, k), cross(odd, k + 1);
        if (k < span.last) cross(even, k);
        return even + odd;
    }
};

/// What is left of the world on one side of a plane, for rays in one direction: n · p + t `closing` <= d.
struct HalfSpaceView {
    Float3 normal;
    float d, closing;
};

/// The medium of the ray caster: values interpolated between voxels, then classified, marched in small steps between
/// the planes that bound it.
template <class Voxel>
struct InterpolatedRays {
    VolumeView<Voxel> volume;
    const float* extinction;  ///< per edge, over the stored values
    float index_scale, index_offset, last_index;
    Float3 voxels_per_cell, direction;  ///< voxels per edge of way
    Float3 origin;                      ///< of the rays in their cells, in edges from the lowest corner
    const HalfSpaceView* planes;
    std::int32_t plane_count;
    float start, step;  ///< edges
    float edge_mm;

    template <class F>
    CHIARO_INLINE F depth(const NodeColumn& nodes, std::int32_t lane, std::int32_t y, std::int32_t z, F depth) const {
        const Vec3<F> p{to_voxel(load_row<F>(nodes.cell_x + lane), origin.x, voxels_per_cell.x),
                        to_voxel(F(float(y)), origin.y, voxels_per_cell.y),
                        to_voxel(F(float(z)), origin.z, voxels_per_cell.z)};
        F in(start), out(1e30f);
        for (std::int32_t i = 0; i < plane_count; ++i) {
            const F room = F(planes[i].d) - dot(Vec3<F>(planes[i].normal), p);
            if (planes[i].closing > 0)
                out = min(out, room / F(planes[i].closing));
            else if (planes[i].closing < 0)
                in = max(in, room / F(planes[i].closing));
            else
                out = select(room < F(0), F(-1), out);
        }
        F at = in;
        for (std::int32_t k = 0; any((at < out) & (depth < F(opaque_depth))); at = mad(F(float(++k)), F(step), in)) {
            const F way = max(min(out - at, F(step)), F(0));  // the last step ends at the exit
            depth = mad(extinction_at(mad(mad(way, F(0.5f), at), Vec3<F>(direction), p)), way, depth);
        }
        return depth;
    }

private:
    template <class F>
    static CHIARO_INLINE F to_voxel(F cell, float origin, float voxels_per_cell) {
        return mad(cell + F(origin), F(voxels_per_cell), F(-0.5f));
    }
    template <class F>
    CHIARO_INLINE F extinction_at(Vec3<F> p) const {
        const Vec3<F> clamped = volume.clamp(p);
        const auto where = volume.locate(clamped, volume.voxel(clamped));
        if (volume.is_mixed()) return F(edge_mm) * alpha_of(volume.matter_at(where));
        const F value = volume.value(where);
        const F index = min(max(mad(value, F(index_scale), F(index_offset)), F(0)), F(last_index));
        const F all = gather_float(extinction, truncate(index));
        return volume.has_factor() ? all * volume.factor_at(where, value) : all;
    }
};

/// Adds what comes from one direction to the sums of a node.
template <class Rays>
struct RayKernel {
    Rays rays;
    Float3 direction;
    Lobe lobe;

    template <class F>
    CHIARO_INLINE void operator()(const NodeColumn& nodes, std::int32_t lane, std::int32_t j, std::int32_t k) const {
        const std::int64_t at = (std::int64_t(k) * nodes.rows_y + j) * NodeColumn::width + lane;
        const F weight = lobe == Lobe::sphere ? F(1) : weight_of<F>(nodes, at);
        const auto counts = weight > F(0);
        if (!any(counts)) return;
        const F start = select(counts, F(0), F(opaque_depth));
        const F depth = rays.template depth<F>(nodes, lane, nodes.y[j], nodes.z[k], start);
        add_to(nodes.light + at, weight * transmittance(depth));
        if (lobe != Lobe::sphere) add_to(nodes.weight + at, weight);
    }

private:
    /// w = (1 - q) m + q lobe(n · ω), m the mean of the lobe over the sphere.
    template <class F>
    CHIARO_INLINE F weight_of(const NodeColumn& nodes, std::int64_t at) const {
        const Vec3<F> n{load_row<F>(nodes.normal_x + at), load_row<F>(nodes.normal_y + at),
                        load_row<F>(nodes.normal_z + at)};
        const F q = load_row<F>(nodes.share + at), cosine = dot(n, Vec3<F>(direction));
        if (lobe == Lobe::hemisphere) return mad(F(1) - q, F(0.5f), select(cosine > F(0), q, F(0)));
        return mad(F(1) - q, F(0.25f), q * max(cosine, F(0)));
    }
};

/// Calls the kernel for every node of the column.
template <class F, class Kernel>
CHIARO_INLINE void run_column(const Kernel& kernel, const NodeColumn& nodes) {
    for (std::int32_t k = 0; k < nodes.rows_z; ++k)
        for (std::int32_t j = 0; j < nodes.rows_y; ++j)
            for (std::int32_t lane = 0; lane < NodeColumn::width; lane += LaneTraits<F>::count)
                kernel.template operator()<F>(nodes, lane, j, k);
}

}  // namespace chiaro::kernel
