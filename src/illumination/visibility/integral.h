// ∫ κ df of the optical table, so that a step from one value to another meets all that lies between them.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "classify/medium.h"
#include "illumination/cells/opacity.h"

namespace chiaro {

/// κ of one cell edge as the ray caster reads it, entry j standing for [j - ½, j + ½), and its integral
/// K(u) = ∫ κ du over the table's index, shifted by ½.
class ExtinctionIntegral {
public:
    ExtinctionIntegral(const Medium::Data& medium, const CellGrid& grid)
        : extinction_(extinction_per_edge(medium, grid)),
          scale_(medium.table.index_scale),
          offset_(medium.table.index_offset + 0.5) {
        for (float kappa : extinction_) before_.push_back(before_.back() + double(kappa));
    }

    /// A stored value's place in the table.
    struct Place {
        double index, integral;
        int entry;
    };
    Place place(double stored) const {
        const double u = stored * scale_ + offset_;
        const int j = int(std::clamp(u, 0.0, double(extinction_.size() - 1)));
        return {u, before_[std::size_t(j)] + (u - j) * double(extinction_[std::size_t(j)]), j};
    }

    float at(const Place& place) const { return extinction_[std::size_t(place.entry)]; }
    /// The mean of κ over the values between two places.
    float mean(const Place& a, const Place& b) const {
        if (a.entry == b.entry) return at(a);
        const double way = b.index - a.index;
        if (std::abs(way) < 1e-6) return 0.5f * (at(a) + at(b));
        return float((b.integral - a.integral) / way);
    }

private:
    std::vector<float> extinction_;
    std::vector<double> before_{0};
    double scale_, offset_;
};

}  // namespace chiaro
