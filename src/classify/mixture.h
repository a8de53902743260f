// What samples of a medium are made of where that is more than one value: channels, labels, colours of their own.
#pragma once
#include "classify/medium.h"

namespace chiaro {

/// One or more channels on one grid, in one stored type; in any order the same bits.
struct MixtureParts {
    std::vector<std::shared_ptr<const Medium::Data>> channels;
    std::shared_ptr<const LabelBricks> labels;  ///< that lie in them, or null
    bool own_colors = false;                    ///< the first has extinction, red, green and blue follow
};

/// The same where a share of it is: bytes in bricks, as labels lie.
std::shared_ptr<const Medium::Data> with_share(const Medium::Data& medium, std::shared_ptr<const VoxelBuffer> share);
Medium mixed(const Device& device, MixtureParts parts, const Shape& shape, const Progress& progress);
/// What a mixture was made of; of another medium that itself.
MixtureParts parts_of(const Medium::Data& medium);

/// Whether it is one channel in which labels lie: rays take its samples as without them, and find after that what they
/// leave and how they tint it.
bool is_labelled_channel(const Medium::Data& medium);

}  // namespace chiaro
