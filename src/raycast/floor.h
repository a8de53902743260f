// The floor under the subject, composited behind it.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/lighting.h>

#include "illumination/field.h"
#include "raycast/render_target.h"

namespace chiaro {

/// Composites the frame over the floor that `lighting` asks for, lit by the field's own kind of light: by the probe
/// where the field holds one's light, by even light with shadows where it holds obscurance, without shadows where it
/// holds nothing. Done on the CPU; the same for any number of threads. Cost: some 30 ns a pixel, and FloorLight's of a
/// light that is new. Returns false when cancelled.
bool put_floor_behind(const Device& device, const Medium::Data& medium, const IlluminationField& field,
                      const Lighting& lighting, const Camera& camera, int lens_rays, RenderTarget& target,
                      Progress& progress);

}  // namespace chiaro
