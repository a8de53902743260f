// Light that is there soon after an edit of a large volume: ambient occlusion of every other voxel, an eighth of the
// work and good enough for a draft.
#pragma once
#include <chiaro/lighting.h>

namespace chiaro {

/// Whether drafts by every other voxel pay, which then are all that the volume is made of: it is whole in this process.
bool is_large(const DeviceVolume& volume);
/// Whether such light is another one.
bool is_soon_lit(const DeviceVolume& volume, const IlluminationSettings& settings);

/// The field for pictures of every other voxel of a volume, classified. Throws Error{interrupted} when cancelled.
IlluminationField light_of_every_other_voxel(const Device& device, const Medium& every_other, const Lighting& lighting,
                                             IlluminationSettings settings, Progress& progress);

/// The same for pictures of the volume itself.
IlluminationField spread_out(const IlluminationField& field);

}  // namespace chiaro
