// How much of a node is a surface: the model of docs/theory/light.md on the grids of light.
#pragma once
#include "illumination/visibility/density.h"

namespace chiaro {

/// [node]: the largest q of points in and about each node whose density differs from a neighbour's, 0 of all others;
/// of isosurfaces 1 everywhere. The points lie at most 1.5 smallest edges apart (of nodes wider than 4 more), up to an
/// edge outside the node. Cost: at most 64 look-ups with gradients for each such node, one where a surface is hard.
Density shares_of_surface(const Medium::Data& medium, const Density& density, const Device& device, Progress& progress);

/// The largest of the 2³ in each node of the grid half as fine.
Density halved_shares(const Density& finer);

}  // namespace chiaro
