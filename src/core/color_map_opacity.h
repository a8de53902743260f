// The opacity of a transfer function that is only a colour map.
#pragma once

namespace chiaro {

/// 0 over the lowest tenth of the values, where the background lies, then a line to a quarter a voxel at the highest:
/// that much lets some ten voxels show through each other. Chosen by eye as far as history shows.
struct ColorMapOpacity {
    static constexpr double start = 0.1;  ///< of the range of values
    static constexpr double highest = 0.25;
};

}  // namespace chiaro
