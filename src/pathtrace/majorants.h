// The largest extinction around every cell, for a transfer function.
#pragma once
#include <vector>

#include "classify/medium.h"

namespace chiaro {

/// What pathtrace/regions.h reads.
struct Majorants {
    std::vector<float>
        cells;  ///< one a 4³ cell, x fastest: the majorant per mm with the region's reach in its low bits
    std::vector<float> runs;  ///< the largest extinction of 2^level entries of the optical table, level by level
};

/// Per mm, in a volume of this size.
float most_extinction(const DeviceVolume::Data& volume);
/// Of the optical table's entries, per mm; at most 2^22 over the longest way. Matter as dense as that lets nothing
/// through in any voxel; in denser matter free ways would be shorter than what floats tell apart, and a path would
/// never move on.
std::vector<float> extinctions_of(const Medium::Data& medium);

/// For each cell the cube of 1, 3, 5, 9 or 17 cells a side around it, or the empty cube that classification found, in
/// which a way of a voxel costs least: regions crossed and expected collisions, each with what it costs. Cells whose
/// majorant is large are left to be bounded voxel by voxel. Cost: some 40 ns a cell on one core. Where `medium` shows
/// isosurfaces the majorant is 1 where one passes, else 0.
Majorants make_majorants(const Medium::Data& medium, int threads);

/// The volume's largest extinction everywhere: plain delta tracking, to compare with.
Majorants one_majorant(const Medium::Data& medium);

}  // namespace chiaro
