// The light probe as paths meet it: what comes from a direction, and directions drawn towards most of it.
#pragma once
#include "kernel/gather.h"
#include "kernel/random.h"
#include "pathtrace/directions.h"

namespace chiaro::kernel {

/// A number drawn among n: each place keeps it with its threshold's probability, else hands it to its alias (Walker
/// 1977).
struct AliasView {
    const float* threshold;
    const float* alias;  ///< whole numbers, as the bits of floats

    template <class F>
    CHIARO_INLINE Int<F> pick(Int<F> first, std::int32_t n, F u, F v) const {
        const Int<F> at = first + min(truncate(u * F(float(n))), Int<F>(n - 1));
        return select(v < gather_float(threshold, at), at - first, bits_of(gather_float(alias, at)));
    }
};

struct ProbeLightView {
    bool even;        ///< the same radiance from everywhere: nothing need be drawn towards it
    Float3 radiance;  ///< if even
    const float* rgb;
    std::int32_t width, height;
    float gain;
    // The bins that are drawn from: as many as pixels, or fewer.
    std::int32_t bins_x, bins_y;
    AliasView rows, columns;
    const float* cosines;           ///< of the angles from up, between the rows of bins
    const float* densities;         ///< per steradian, of each bin
    Float3 axis_x, axis_y, axis_z;  ///< the probe's own axes in the world

    template <class F>
    struct Seen {
        Vec3<F> radiance;
        F density;  ///< with which `towards` draws this direction, per steradian
    };

    /// In a unit direction of the world. Radiance is constant in each pixel.
    template <class F>
    CHIARO_INLINE Seen<F> at(Vec3<F> direction) const {
        if (even) return {Vec3<F>(radiance), F(0)};
        const F x = dot(Vec3<F>(axis_x), direction), y = dot(Vec3<F>(axis_y), direction),
                z = dot(Vec3<F>(axis_z), direction);
        const F across = F(0.5f) - angle_in_turns(y, x), down = F(2) * angle_in_turns(sqrt(mad(x, x, y * y)), z);
        const auto place = [](F share, std::int32_t n) CHIARO_INLINE_LAMBDA {
            return min(truncate(max(share, F(0)) * F(float(n))), Int<F>(n - 1));
        };
        return of<F>(place(down, height) * Int<F>(width) + place(across, width),
                     place(down, bins_y) * Int<F>(bins_x) + place(across, bins_x));
    }

    template <class F>
    struct Drawn {
        Vec3<F> direction;
        Seen<F> light;
    };

    /// A unit direction of the world, drawn in proportion to the bins' luminance, and what comes from there.
    template <class F>
    CHIARO_INLINE Drawn<F> towards(const Draw<F>& bin, const Draw<F>& within) const {
        const Int<F> row = rows.pick<F>(Int<F>(0), bins_y, bin.a, bin.b);
        const Int<F> column = columns.pick<F>(row * Int<F>(bins_x), bins_x, bin.c, within.a);
        const F top = gather_float(cosines, row), bottom = gather_float(cosines + 1, row);
        const F z = lerp(top, bottom, within.b), r = sqrt(max(F(1) - z * z, F(0)));
        // Azimuth 360° (½ - s): half a turn before 0 at the left.
        F turns = F(0.5f) - (to_float(column) + within.c) * F(1 / float(bins_x));
        turns = select(turns < F(0), turns + F(1), turns);
        const SinCos<F> azimuth = sin_cos(turns);
        const Vec3<F> direction =
            mad(r * azimuth.cos, Vec3<F>(axis_x), mad(r * azimuth.sin, Vec3<F>(axis_y), z * Vec3<F>(axis_z)));
        if (bins_x != width || bins_y != height) return {direction, at<F>(direction)};
        const Int<F> pixel = row * Int<F>(bins_x) + column;
        return {direction, of<F>(pixel, pixel)};
    }

private:
    template <class F>
    CHIARO_INLINE Seen<F> of(Int<F> pixel, Int<F> bin) const {
        const Int<F> i = pixel * Int<F>(3);
        return {F(gain) * Vec3<F>{gather_float(rgb, i), gather_float(rgb + 1, i), gather_float(rgb + 2, i)},
                gather_float(densities, bin)};
    }
};

}  // namespace chiaro::kernel
