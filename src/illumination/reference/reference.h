// The truth by brute force: rays from every cell in all directions (Kroes, Schut and Eisemann's ray-traced column).
#pragma once
#include "illumination/access.h"

namespace chiaro {

/// F of the ambient occlusion that rays find: any normal that can be told from noise decides.
inline constexpr double reference_normal_factor = 2.5;

/// Step of the march through the interpolated medium, in cell edges.
inline constexpr double reference_step = 0.25;

/// V along N Fibonacci directions, averaged over the sphere or over the hemisphere about the outward normal. Fills the
/// cells of the given blocks. Cost: rays × cells crossed.
CellValues reference_accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                                   const ReferenceSettings& settings, const BlockMap& blocks, StageTimer& timer,
                                   Progress& progress, double step = reference_step);

}  // namespace chiaro
