// Light that is there soon after an edit of a large volume: ambient occlusion of every other voxel, an eighth of the
// work and good enough for a draft.
#pragma once
#include <chiaro/lighting.h>

namespace chiaro {

/// Whether it pays, and knows all that the volume is made of, which is whole in this process.
bool is_soon_lit(const DeviceVolume& volume, const IlluminationSettings& settings);

/// The field for pictures of the volume whose every other voxel, classified, is given. Throws Error{interrupted} when
/// cancelled.
IlluminationField light_of_every_other_voxel(const Device& device, const Medium& every_other, const Lighting& lighting,
                                             IlluminationSettings settings, Progress& progress);

}  // namespace chiaro
