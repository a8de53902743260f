// A matte floor under the subject (docs/theory/light.md, "The floor").
#pragma once
#include <chiaro/lighting.h>

#include <optional>

#include "classify/medium.h"
#include "illumination/floor/floor_view.h"
#include "illumination/sh/rotation.h"

namespace chiaro {

/// Where it lies, in the world.
struct Floor {
    Vec3 up;               ///< unit
    double height_mm = 0;  ///< along it
    Vec3 centre;           ///< on the floor, under the middle of what is visible
    double radius_mm = 1;  ///< of the circle around what is visible, seen from above

    bool operator==(const Floor&) const = default;

    /// Along u and v, and up.
    static Axes axes(Vec3 up);
    /// The point that lies so many radii along u and v.
    Vec3 point(double u, double v) const;
};

/// Under the lowest voxel of opacity >= .1 (of isosurfaces: within one), or of less where there is none; none where
/// nothing is visible. Cost: a look at each occupied cell's place, and at the voxels of the lowest.
std::optional<Floor> find_floor(const Medium::Data& medium, Vec3 up);

/// As rays in voxel coordinates meet it.
kernel::FloorView view_of(const Floor& floor, const Geometry& geometry);

/// The light above a floor: from below comes what an open floor reflects, its albedo times the light on it. Exposure is
/// stated; without a floor nothing changes.
Lighting above_floor(const Lighting& lighting);

}  // namespace chiaro
