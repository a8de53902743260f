// What all methods are asked alike, so that they can be compared: the light on particles (docs/methods.md).
#pragma once
#include <chiaro/scene.h>

namespace chiaro {

/// The scene as a picture shows it, lit by the method; or by the reference that the method is judged by.
Scene as_shown(const Scene& scene, Method method);
Scene reference_of(const Scene& scene, Method method);
/// What light that reference follows.
std::string light_of_reference(const Scene& scene, Method method);

/// The scene without shading, background and exposure of the picture, lit by the method as compare_methods says.
Scene plainly_lit(const Scene& scene, Method method);

/// Whether what a method finds is light, not the share of it that arrives.
bool finds_light(const IlluminationSettings& settings);

/// Of the lighting's probe, which is loaded, over the whole sphere.
Rgb mean_radiance(const Lighting& lighting);

}  // namespace chiaro
