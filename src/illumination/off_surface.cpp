#include "illumination/off_surface.h"

#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {

kernel::OffSurface off_surface_of(const Geometry& geometry) {
    const Axes rows = transposed(grid_from_world(geometry));
    const double edge = geometry.smallest_spacing_mm();
    const Vec3& spacing = geometry.spacing_mm;
    return {float3(rows[0]), float3(rows[1]), float3(rows[2]),
            float3(Vec3{edge / spacing.x, edge / spacing.y, edge / spacing.z})};
}

}  // namespace chiaro
