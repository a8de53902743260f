// Half way from a cell's value to its neighbour's the cell ends: a sixth of the mean of κ over the values passed on the
// way, so that six of them are a cell's κ. Three ways to the same number, by how many values there are.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// κ of one cell edge as the ray caster reads it, entry j of the optical table standing for [j - ½, j + ½), and its
/// integral K(u) = ∫ κ du over the table's index, shifted by ½.
struct IntegralView {
    const float* extinction;
    const double* before;  ///< up to each entry
    double scale, offset, last;

    /// A stored value's place in the table.
    struct Place {
        double index, integral;
        std::int32_t entry;
    };
    CHIARO_INLINE Place place(double stored) const {
        const double u = stored * scale + offset;
        const std::int32_t j = std::int32_t(u < 0 ? 0 : last < u ? last : u);
        return {u, before[j] + (u - j) * double(extinction[j]), j};
    }

    CHIARO_INLINE float at(const Place& place) const { return extinction[place.entry]; }
    /// The mean of κ over the values between two places.
    CHIARO_INLINE float mean(const Place& a, const Place& b) const {
        if (a.entry == b.entry) return at(a);
        const double way = b.index - a.index;
        if (-1e-6 < way && way < 1e-6) return 0.5f * (at(a) + at(b));
        return float((b.integral - a.integral) / way);
    }
};

/// Of any value: two places in the table, and a quotient.
struct SubVoxelIntegralOfAny {
    using Level = float;
    IntegralView integral;

    CHIARO_INLINE Level level_of(float stored) const { return stored; }

    struct From {
        const IntegralView& integral;
        IntegralView::Place place;
        float value;
        CHIARO_INLINE float to(float neighbour) const {
            if (neighbour == value) return integral.at(place) * (1.0f / 6);
            return integral.mean(place, integral.place(0.5 * (double(value) + double(neighbour)))) * (1.0f / 6);
        }
    };
    CHIARO_INLINE From from(float value) const { return {integral, integral.place(double(value)), value}; }
};

/// Of whole levels of the stored value, `per_unit` a unit: the integral at every half level.
struct SubVoxelIntegralOfLevels {
    using Level = std::int32_t;
    const double *integral, *inverse;  ///< K / 3 at half levels; 1 / way, of ways from -last to last
    const float* sixth;
    std::int32_t per_unit;
    float low;
    std::int32_t last, unused;

    CHIARO_INLINE Level level_of(float stored) const {
        return max(min(std::int32_t((stored - low) * float(per_unit) + 0.5f), last), 0);
    }

    struct From {
        const double *integral, *inverse;  ///< K at this level; 1 / way
        float sixth;
        std::int32_t level;
        CHIARO_INLINE float to(std::int32_t neighbour) const {
            const std::int32_t way = neighbour - level;
            return way == 0 ? sixth : float((integral[way] - *integral) * inverse[way]);
        }
    };
    CHIARO_INLINE From from(std::int32_t level) const {
        return {integral + 2 * level, inverse + last, sixth[level], level};
    }
};

/// Of stored whole numbers.
template <class Voxel>
struct SubVoxelIntegralOfVoxels {
    SubVoxelIntegralOfLevels levels;
    std::int32_t low, unused;

    struct From {
        SubVoxelIntegralOfLevels::From level;
        std::int32_t low;
        CHIARO_INLINE float to(Voxel neighbour) const { return level.to(std::int32_t(neighbour) - low); }
    };
    CHIARO_INLINE From from(Voxel value) const { return {levels.from(std::int32_t(value) - low), low}; }
};

/// Of 8 bits: all pairs in a table.
template <>
struct SubVoxelIntegralOfVoxels<std::uint8_t> {
    const float* pairs;  ///< [256][256]

    struct From {
        const float* pairs;
        CHIARO_INLINE float to(std::uint8_t neighbour) const { return pairs[neighbour]; }
    };
    CHIARO_INLINE From from(std::uint8_t value) const { return {pairs + 256 * std::int32_t(value)}; }
};

/// κ of a cell among its neighbours, `row` and `slice` apart.
template <class SubVoxelIntegral, class Value>
CHIARO_INLINE float depth_among(const SubVoxelIntegral& sub_voxel, const Value* at, std::int32_t row,
                                std::int32_t slice) {
    const auto here = sub_voxel.from(*at);
    return (here.to(at[-1]) + here.to(at[1])) + (here.to(at[-row]) + here.to(at[row])) +
           (here.to(at[-slice]) + here.to(at[slice]));
}

}  // namespace chiaro::kernel
