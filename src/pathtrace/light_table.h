// The light probe as the path tracer's kernel reads it.
#pragma once
#include <chiaro/lighting.h>

#include <vector>

#include "core/host_array.h"
#include "pathtrace/light_view.h"

namespace chiaro {

/// Tables to draw directions from in constant time (Walker 1977, Vose 1991): first a row, then a bin of it, in
/// proportion to luminance × solid angle. Bins are the probe's pixels, or squares of 2^k of them where the picture has
/// more than 2^21. Memory: 12 bytes a bin.
class LightTable {
public:
    LightTable(const Lighting& lighting, Vec3 orbit_up);
    kernel::ProbeLightView view() const;
    void add_to(HostArrays& arrays) const;  ///< what the view points into

private:
    void make_bins();

    const Lighting lighting_;
    const Vec3 up_;
    Probe probe_;
    int bins_x_ = 1, bins_y_ = 1;
    bool even_ = false;
    std::vector<float> row_threshold_, row_alias_, column_threshold_, column_alias_, cosines_, densities_;
};

}  // namespace chiaro
