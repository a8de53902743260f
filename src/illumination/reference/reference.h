// The truth by brute force: rays from every cell in all directions (Kroes, Schut and Eisemann's ray-traced column).
#pragma once
#include "illumination/access.h"

namespace chiaro {

/// V by full marching along N Fibonacci directions, averaged over the sphere or over the hemisphere about the outward
/// normal. Cost: rays × cells crossed.
CellValues reference_accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                                   const ReferenceSettings& settings, const BlockMap& blocks, Steps& steps,
                                   Progress& progress);

}  // namespace chiaro
