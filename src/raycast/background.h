// What lies behind the volume: the light probe, seen along each pixel's ray.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/image.h>
#include <chiaro/lighting.h>

#include "cuda/pixels.h"

namespace chiaro {

/// Composites the frame over the probe that lights, turned and exposed; alpha becomes 1. The probe is infinitely far
/// off: an orthographic camera sees one direction of it. With ColorMode::display its light is encoded as the frame's
/// is. The same for any number of threads. Cost: some 50 ns a pixel. Returns false when cancelled.
bool put_probe_behind(const Device& device, const Lighting& lighting, const Camera& camera, ColorMode color,
                      Frame& frame, Progress& progress);
/// Of a frame that lies on a card, there.
void put_probe_behind(cuda::Pixels& pixels, const Lighting& lighting, const Camera& camera, ColorMode color, int width,
                      int height);

}  // namespace chiaro
