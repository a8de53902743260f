// Pre-integration (Engel, Kraus and Ertl 2001): colour and opacity of a step along which the value runs evenly from one
// value to another, attenuation within the step included.
#pragma once
#include <vector>

#include "classify/medium.h"
#include "kernel/rgba.h"

namespace chiaro {

/// Over nodes of both values; as raycast/tables.h reads it.
struct SegmentTable {
    std::vector<kernel::Rgba> entries;  ///< [near][far]
    std::vector<float> visible_before;  ///< how many entries of the optical table before each are visible
    int nodes = 0;
    double scale = 1, offset = 0;  ///< node = stored * scale + offset
};

/// At 8 bit each stored value has a node, or more where few occur. More bits are quantised to nodes, and interpolated.
inline constexpr int byte_intervals = 256, wide_intervals = 512;

/// Cost: n² exponentials and 6 n² compositions for n nodes: some 2 to 4 ms on two cores for 8 bit, 10 ms for more.
SegmentTable make_segment_table(const DeviceVolume::Data& volume, const OpticalTable& table, double step_mm,
                                int threads);

/// The medium's, its colours scaled down to `albedo_limit`; it keeps the last one, so that frames of the same steps
/// share it, and a GPU knows it.
std::shared_ptr<const SegmentTable> segment_table(const Medium::Data& medium, double step_mm,
                                                  std::optional<double> albedo_limit, int threads);

}  // namespace chiaro
