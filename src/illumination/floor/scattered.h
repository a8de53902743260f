// What matter has scattered, on the floor.
#pragma once
#include "illumination/floor/floor_light.h"
#include "illumination/transport/nodes.h"

namespace chiaro {

/// Adds to E/π of the floor `factor` × what comes from the grid of light that was scattered: where a direction enters
/// the grid - on the floor under it at once - radiance is J + 3 m · ω, as its first two moments have it. Nothing where
/// all are particles. Cost: 64² points × 128 directions.
void add_scattered(LitFloor& lit, const TransportNodes& nodes, const Floor& floor, const Geometry& geometry,
                   double factor, int threads);

}  // namespace chiaro
