// How distances from the border of what labels show are stored.
#pragma once
#include <cstdint>

namespace chiaro {

/// Signed distances in a byte: middle + per_voxel * voxels, positive in what is shown.
struct LabelCoding {
    static constexpr int middle = 128, reach = 2;
    static constexpr float per_voxel = 63;
    static constexpr std::uint8_t shown = 254, hidden = 2;  ///< farther than `reach` from a border
    static constexpr std::uint8_t deep = 255;  ///< shown so, and the eight voxels from this one on wholly shown
};

/// Tints in a word: red, green and blue as square roots of 255, whether the eight voxels from this one on have several
/// tints, and how much it is, of 127.
struct TintCoding {
    static constexpr std::uint32_t several = 1u << 24;
    static constexpr int strength_shift = 25, strength_bits = 127;
};

}  // namespace chiaro
