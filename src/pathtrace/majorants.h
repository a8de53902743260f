// The largest extinction around every cell, for a transfer function.
#pragma once
#include <vector>

#include "classify/medium.h"

namespace chiaro {

/// As pathtrace/regions.h reads them: one float a 4³ cell, the majorant per mm with the region's reach in its low bits.
using Majorants = std::vector<float>;

/// For each cell the cube of 1, 3, 5, 9 or 17 cells a side around it, or the empty cube that classification found, in
/// which a way of a voxel costs least: `step_cost` × regions crossed + expected collisions, in units of a collision.
/// Cost: some 40 ns a cell on one core. Where `medium` shows isosurfaces the majorant is 1 where one passes, else 0.
Majorants make_majorants(const Medium::Data& medium, int threads);

/// The volume's largest extinction everywhere: plain delta tracking, to compare with.
Majorants one_majorant(const Medium::Data& medium);

}  // namespace chiaro
