// What is seen at a pixel.
#pragma once
#include <chiaro/export.h>
#include <chiaro/render.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace chiaro {

/// The sample that contributes most to a pixel.
struct Pick {
    double value = 0;     ///< in data units
    Vec3 p_voxel;         ///< where, in voxels ...
    Vec3 world_mm;        ///< ... and in the world
    double depth_mm = 0;  ///< from the eye; orthographic: from the plane through the eye
    double opacity = 0;   ///< of the value, over one opacity unit; of an isosurface its own
    Rgb rgb{0, 0, 0};     ///< sRGB, of the value or surface before light
    double weight = 0;    ///< T α: the opacity that the sample brings to the pixel; a maximum's: that of its value
    double covered = 0;   ///< the pixel's whole opacity
};

/// Casts one ray through (x, y) of a picture of width × height pixels, from its top left corner, as `raycast` does (but
/// for glow), and finds the sample or surface with the largest weight T α, the first of equals; with Mode::mip and
/// minip the value's place. Nothing where the ray meets no matter, and with mean and additive. Cost: one ray, not
/// vectorised: some microseconds to a millisecond, pre-integrated the table of `raycast`.
CHIARO_EXPORT std::optional<Pick> pick(const Medium& medium, const Camera& camera, const RaySettings& settings,
                                       int width, int height, double x, double y);
/// The same at many places (x, y), in their order: what a call prepares is prepared once. On all of the volume's
/// threads.
CHIARO_EXPORT std::vector<std::optional<Pick>> pick(const Medium& medium, const Camera& camera,
                                                    const RaySettings& settings, int width, int height,
                                                    std::span<const std::array<double, 2>> places);

}  // namespace chiaro
