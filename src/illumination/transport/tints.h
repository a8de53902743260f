// What colour a stored value scatters, and how much it weighs.
#pragma once
#include <algorithm>
#include <array>

#include "classify/medium.h"

namespace chiaro {

struct Tint {
    float weight = 0;               ///< extinction; of isosurfaces 1
    std::array<float, 3> colour{};  ///< albedo × weight
};

class Tints {
public:
    /// Each colour is scaled down to `albedo_max` where a channel is above.
    Tints(const Medium::Data& medium, double albedo_max);

    /// Of a stored value; of isosurfaces that of the nearest one.
    const Tint& of(float stored) const {
        return entries_[std::size_t(std::clamp(stored * scale_ + offset_, 0.0f, last_))];
    }
    /// Over all values alike; of weight > 0.
    Tint mean() const;

private:
    std::vector<Tint> entries_;
    float scale_, offset_, last_;
};

}  // namespace chiaro
