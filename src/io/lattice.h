// Coarser levels of what has none of its own: every second voxel, every fourth, ...
#pragma once
#include <chiaro/brick_source.h>

namespace chiaro {

/// Which voxels of a grid a level has: first + i * stride, per axis.
struct Lattice {
    std::array<int, 3> first{0, 0, 0}, stride{1, 1, 1};
};

struct ThinnedLevel {
    SourceLevel level;
    Lattice lattice;  ///< of the grid that they were made of
};

/// The grid itself, and the coarser ones, down to least_level_edge. Axes whose voxels are twice as wide as others
/// already are not thinned out: so voxels become cubes.
std::vector<ThinnedLevel> thinned(const SourceLevel& grid);

/// The header of a source of `file`: numbers of up to 16 bits and floats are kept, all others become floats.
Volume kept_header(const Volume& file);

}  // namespace chiaro
