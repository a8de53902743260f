// How distances from the border of what labels show are stored.
#pragma once
#include <cstdint>

namespace chiaro {

/// Signed distances in a byte: middle + per_voxel * voxels, positive in what is shown.
struct LabelCoding {
    static constexpr int middle = 128, reach = 2;
    static constexpr float per_voxel = 63;
    static constexpr std::uint8_t shown = 254, hidden = 2;  ///< farther than `reach` from a border
};

}  // namespace chiaro
