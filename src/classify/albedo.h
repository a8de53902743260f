// The share of light that matter scatters on, from its colour.
#pragma once
#include <algorithm>
#include <optional>

#include "classify/medium.h"

namespace chiaro {

/// What a colour is multiplied by to be an albedo whose largest channel is at most `most`; none: it stays as it is.
inline float albedo_factor(float r, float g, float b, std::optional<double> most) {
    const double largest = std::max({r, g, b});
    return most && largest > *most ? float(*most / largest) : 1.0f;
}

/// With albedos for colours.
inline OpticalTable with_albedos(OpticalTable table, std::optional<double> most) {
    for (OpticalTable::Entry& e : table.entries) {
        const float factor = albedo_factor(e.r, e.g, e.b, most);
        e.r *= factor, e.g *= factor, e.b *= factor;
    }
    return table;
}

}  // namespace chiaro
