// Lights as an environment map: so that methods which follow light throw their shadows.
#pragma once
#include <chiaro/lighting.h>

namespace chiaro {

/// What `--probe` calls it.
inline constexpr const char* lights_probe = "lights";

/// Darkness with a soft disc, some 4° wide, for each light: a white matte surface that faces it gets its colour. Throws
/// Error{usage} for lights that are not fixed to the world's directions, and where there is none.
Probe probe_of_lights(const std::vector<Light>& lights);

}  // namespace chiaro
