// The values of a labelled volume, numbered from 0 on.
#pragma once
#include <chiaro/labels.h>

namespace chiaro {

struct Numbered {
    VoxelBuffer numbers;                ///< uint16 for each voxel, of component `component`
    std::vector<std::uint32_t> values;  ///< of each number: first 0, then those that occur, rising
};
/// Throws Error{input} naming `volume.source` where a value is no label, or where there are too many.
Numbered numbered(const Volume& volume, int component);

}  // namespace chiaro
