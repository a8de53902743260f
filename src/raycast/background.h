// What lies behind the volume: the light probe, seen along each pixel's ray.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/lighting.h>

#include "raycast/render_target.h"

namespace chiaro {

/// Composites the frame over the probe that lights, turned and exposed; alpha becomes 1. The probe is infinitely far
/// off: an orthographic camera sees one direction of it. With ColorMode::display its light is encoded as the frame's
/// is. Done where the pixels are; the same for any number of threads. Cost: some 50 ns a pixel. Returns false when
/// cancelled.
bool put_probe_behind(const Device& device, const Lighting& lighting, const Camera& camera, ColorMode color,
                      RenderTarget& target, Progress& progress);

}  // namespace chiaro
