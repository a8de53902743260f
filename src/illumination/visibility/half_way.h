// Half way from a cell's value to its neighbour's the cell ends: a sixth of the mean of κ over the values passed on the
// way, so that six of them are a cell's κ. Three ways to the same number, by how many values there are.
#pragma once
#include "illumination/visibility/integral.h"

namespace chiaro {

/// Of any value: two places in the table, and a quotient.
class HalfWayOfAny {
public:
    using Level = float;
    Level level_of(float stored) const { return stored; }

    explicit HalfWayOfAny(const ExtinctionIntegral& integral) : integral_(integral) {}

    struct From {
        const ExtinctionIntegral& integral;
        ExtinctionIntegral::Place place;
        float value;
        float to(float neighbour) const {
            if (neighbour == value) return integral.at(place) * (1.0f / 6);
            return integral.mean(place, integral.place(0.5 * (double(value) + double(neighbour)))) * (1.0f / 6);
        }
    };
    From from(float value) const { return {integral_, integral_.place(double(value)), value}; }

private:
    ExtinctionIntegral integral_;
};

/// Of whole levels of the stored value, `per_unit` a unit: the integral at every half level.
class HalfWayOfLevels {
public:
    using Level = int;

    HalfWayOfLevels(const ExtinctionIntegral& integral, const DeviceVolume::Data& volume, int per_unit)
        : per_unit_(per_unit), low_(volume.stored_min), last_(int((volume.stored_max - low_) * float(per_unit))) {
        const double index_per_level = integral.place(low_ + 1.0 / per_unit).index - integral.place(low_).index;
        for (int half = 0; half <= 2 * last_; ++half) {
            const auto place = integral.place(low_ + 0.5 * half / per_unit);
            integral_.push_back(place.integral / (3 * index_per_level));
            if (half % 2 == 0) sixth_.push_back(integral.at(place) / 6);
        }
        for (int way = -last_; way <= last_; ++way) inverse_.push_back(way == 0 ? 0 : 1.0 / way);
    }

    int level_of(float stored) const { return std::clamp(int((stored - low_) * float(per_unit_) + 0.5f), 0, last_); }

    struct From {
        const double *integral, *inverse;  ///< K at this level; 1 / way
        float sixth;
        int level;
        float to(int neighbour) const {
            const int way = neighbour - level;
            return way == 0 ? sixth : float((integral[way] - *integral) * inverse[way]);
        }
    };
    From from(int level) const {
        return {&integral_[2 * std::size_t(level)], &inverse_[std::size_t(last_)], sixth_[std::size_t(level)], level};
    }

private:
    int per_unit_;
    float low_;
    int last_;
    std::vector<double> integral_, inverse_;
    std::vector<float> sixth_;
};

/// Of stored whole numbers.
template <class Voxel>
class HalfWayOfVoxels {
public:
    HalfWayOfVoxels(const ExtinctionIntegral& integral, const DeviceVolume::Data& volume)
        : low_(int(volume.stored_min)), levels_(integral, volume, 1) {}
    struct From {
        HalfWayOfLevels::From level;
        int low;
        float to(Voxel neighbour) const { return level.to(int(neighbour) - low); }
    };
    From from(Voxel value) const { return {levels_.from(int(value) - low_), low_}; }

private:
    int low_;
    HalfWayOfLevels levels_;
};

/// Of 8 bits: all pairs in a table.
template <>
class HalfWayOfVoxels<std::uint8_t> {
public:
    HalfWayOfVoxels(const ExtinctionIntegral& integral, const DeviceVolume::Data& volume) : pairs_(256 * 256) {
        const HalfWayOfAny any(integral);
        for (int value = int(volume.stored_min); value <= int(volume.stored_max); ++value)
            for (int other = int(volume.stored_min); other <= int(volume.stored_max); ++other)
                pairs_[std::size_t(256 * value + other)] = any.from(float(value)).to(float(other));
    }
    struct From {
        const float* pairs;
        float to(std::uint8_t neighbour) const { return pairs[neighbour]; }
    };
    From from(std::uint8_t value) const { return {&pairs_[256 * std::size_t(value)]}; }

private:
    std::vector<float> pairs_;
};

}  // namespace chiaro
