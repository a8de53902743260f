// What labels make of a medium, in bricks as the volume's voxels lie (volume/bricks.h).
#pragma once
#include <chiaro/transfer_function.h>

#include <optional>
#include <vector>

#include "volume/label_coding.h"

namespace chiaro {

/// Where matter is by one transfer function, of several that labels have.
struct TransferShare {
    std::optional<TransferFunction> transfer;  ///< none: the volume's
    VoxelBuffer share;                         ///< uint8, of 255
};

struct LabelBricks {
    VoxelBuffer distance;  ///< uint8, of the border of what is shown; empty: all is
    VoxelBuffer share;     ///< uint8, of 255: opacity; empty: 1
    VoxelBuffer tint;      ///< uint32, as TintCoding has it; empty: none
    /// Of each 4³ cell the word of its tint, where it has one and all is shown from two voxels before it to two behind;
    /// else TintCoding::several. x fastest.
    std::vector<std::uint32_t> cells;
    /// Whether they hide or thin anything.
    bool cuts() const { return distance.size() || share.size(); }
    std::vector<TransferShare> transfers;  ///< whose shares add up to 255; empty: all is by the volume's
};

}  // namespace chiaro
