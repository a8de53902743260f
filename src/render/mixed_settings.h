// Scenes between scenes.
#pragma once
#include <chiaro/scene.h>

namespace chiaro {

/// All settings but the camera's, a share t in [0, 1] of the way from a to b: numbers evenly, the rest as `a` until t
/// is 1.
Scene mixed_settings(const Scene& a, const Scene& b, double t);

/// The camera at `seconds` on a smooth path through those of the scenes at `times`.
CameraSettings camera_on_path(const std::vector<double>& times, const std::vector<const Scene*>& scenes,
                              const Geometry& geometry, const std::array<int, 3>& dimensions, double seconds);

}  // namespace chiaro
