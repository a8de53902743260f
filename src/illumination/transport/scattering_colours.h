// What colour a stored value scatters, and how much it weighs.
#pragma once
#include "classify/medium.h"
#include "illumination/transport/colour_kernel.h"

namespace chiaro {

using kernel::ScatteringColour;

class ScatteringColours {
public:
    /// Each colour is scaled down to `albedo_max` where a channel is above.
    ScatteringColours(const Medium::Data& medium, double albedo_max);

    /// Of stored values, or of mixtures; of isosurfaces that of the nearest one.
    kernel::ScatteringColourView view() const { return {entries_.data(), scale_, offset_, last_, most_}; }
    void add_to(HostArrays& arrays) const { arrays.add(entries_); }
    /// Over all values alike; of weight > 0.
    ScatteringColour mean() const;

private:
    std::vector<ScatteringColour> entries_;
    float scale_, offset_, last_, most_;
};

}  // namespace chiaro
