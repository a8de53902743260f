// A method's own answer at single points.
#pragma once
#include <chiaro/camera.h>

#include <span>

#include "classify/medium.h"
#include "illumination/field.h"

namespace chiaro {

/// E on particles at points in voxels, as the ray caster would look it up there without shading: of methods that know a
/// share of light and no direction that share, in all channels.
std::vector<Rgb> light_at(const IlluminationField& field, const Lighting& lighting, const Camera& camera,
                          const Medium::Data& medium, std::span<const Vec3> points_voxel);

}  // namespace chiaro
