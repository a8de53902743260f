// A sun's light goes along straight rays: what arrives at a cell's border, and what of it is left behind the cell.
#pragma once
#include "illumination/transport/light_kernel.h"
#include "illumination/transport/sweep_kernel.h"

namespace chiaro::kernel {

/// The cells as the sun sees them.
struct SunlitCells {
    CellPlaces places;
    const float* visibility;  ///< four coefficients a cell
    double open;              ///< the first coefficient where nothing is in the way

    CHIARO_INLINE double arriving(std::int64_t cell) const { return visibility[4 * cell] / open; }
};

/// The share of each cell: below 0 in opaque ones that show no face.
struct DominantLightShareKernel {
    SunlitCells cells;
    const float* depth;
    const std::uint8_t* clear;  ///< 0: opaque. With a halo of one
    const std::int32_t* ids;    ///< with the halo
    std::int64_t shown;         ///< ids below this show a face
    double length;              ///< edges from plane to plane
    double* mean;

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = cells.places.in_halo(cell);
        const bool is_opaque = clear[at] == 0, shows_none = ids[at] < 0 || ids[at] >= shown;
        const double passed = is_opaque ? 0 : depth[cell];
        mean[cell] = is_opaque && shows_none ? -1 : cells.arriving(cell) * (1 + ::exp(-passed * length)) / 2;
    }
};

/// On the faces of a cell that shows some: irradiance / π, light being ∫ L dω / 4π.
struct DominantLightFacesKernel {
    SunlitCells cells;
    const std::size_t* nodes;     ///< of the cells
    const std::uint32_t* around;  ///< of these
    double light[3], direction[3];
    OctantRays rays;
    float weight[4];
    float* faces;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const auto cell = std::int64_t(nodes[i]);
        const std::int32_t pattern = rays.pattern(around[i]);
        float share = 0;
        for (std::int32_t tap = 0; tap < 4; ++tap)
            if (pattern >> tap & 1) share += weight[tap];
        if (share < least_open) return;
        const double seen = cells.arriving(cell) / share, arriving = seen < 1 ? seen : 1;
        for (std::int32_t axis = 0; axis < 3; ++axis)
            for (std::int32_t c = 0; c < 3; ++c)
                faces[(i * 6 + 2 * axis + (direction[axis] < 0)) * 4 + c] +=
                    float(4 * light[c] * ::fabs(direction[axis]) * arriving);
    }
};

}  // namespace chiaro::kernel
