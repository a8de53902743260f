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

    double length;  ///< edges from plane to plane

    CHIARO_INLINE double arriving(std::int64_t cell) const { return visibility[4 * cell] / open; }
    /// What a neighbour, a bit of OpaqueCell::around, sends on; all of it from outside the grid.
    CHIARO_INLINE double sent(std::int64_t cell, std::int32_t bit, const float* depth) const {
        const std::int64_t x = cell % places.nx + bit % 3 - 1, y = cell / places.nx % places.ny + bit / 3 % 3 - 1,
                           z = cell / places.nx / places.ny + bit / 9 - 1;
        if (x < 0 || y < 0 || z < 0 || x >= places.nx || y >= places.ny || z >= places.nz) return 1;
        const std::int64_t at = (z * places.ny + y) * places.nx + x;
        return arriving(at) * ::exp(-depth[at] * length);
    }
};

/// The share of each cell: below 0 in opaque ones that show no face.
struct DominantLightShareKernel {
    SunlitCells cells;
    const float* depth;
    const std::uint8_t* clear;  ///< 0: opaque. With a halo of one
    const std::int32_t* ids;    ///< with the halo
    std::int64_t shown;         ///< ids below this show a face
    double* mean;

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = cells.places.in_halo(cell);
        const bool is_opaque = clear[at] == 0, shows_none = ids[at] < 0 || ids[at] >= shown;
        const double passed = is_opaque ? 0 : depth[cell];
        mean[cell] = is_opaque && shows_none ? -1 : cells.arriving(cell) * (1 + ::exp(-passed * cells.length)) / 2;
    }
};

/// An opaque cell as a step of a slope: several of its faces are in the open, and diagonally before or behind it lies
/// another step.
struct StepOfSlope {
    std::int32_t side[3];  ///< of each axis: -1 or 1: the one face in the open; 0: none is, or both
    bool is_one = false;

    /// `around`: OpaqueCell::around.
    CHIARO_INLINE explicit StepOfSlope(std::uint32_t around) {
        const std::int32_t bits[3]{1, 3, 9};
        for (std::int32_t axis = 0; axis < 3; ++axis)
            side[axis] = is_clear(around, bits[axis]) - is_clear(around, -bits[axis]);
        for (std::int32_t axis = 0; axis < 3; ++axis) {
            const std::int32_t other = (axis + 1) % 3;
            const std::int32_t diagonal = side[axis] * bits[axis] - side[other] * bits[other];
            if (side[axis] && side[other]) is_one |= !is_clear(around, diagonal) || !is_clear(around, -diagonal);
        }
    }
    /// With a direction, of a normal midway between the faces in the open.
    CHIARO_INLINE double cosine(const double (&direction)[3]) const {
        double sum = 0, faces = 0;
        for (std::int32_t axis = 0; axis < 3; ++axis) sum += side[axis] * direction[axis], faces += abs(side[axis]);
        return sum / ::sqrt(faces);
    }

private:
    static CHIARO_INLINE std::int32_t is_clear(std::uint32_t around, std::int32_t bit) {
        return around >> (13 + bit) & 1;
    }
};

/// On the faces of a cell that shows some: irradiance / π, light being ∫ L dω / 4π; what the clear cells before it
/// send, since a ray to its middle may pass through its neighbours. A step of a slope has the slope's on each of its
/// faces: steps light each other along their edges, where cells do not see each other.
struct DominantLightFacesKernel {
    SunlitCells cells;
    const float* depth;
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
        double sent = 0;
        for (std::int32_t tap = 0; tap < 4; ++tap)
            if (pattern >> tap & 1) share += weight[tap], sent += weight[tap] * cells.sent(cell, rays.back[tap], depth);
        if (share < least_open) return;
        const StepOfSlope step(around[i]);
        for (std::int32_t face = 0; face < 6; ++face) {
            const std::int32_t axis = face / 2, side = face % 2 ? -1 : 1;
            const bool is_of_slope = step.is_one && step.side[axis] == side;
            const double cosine = is_of_slope ? step.cosine(direction) : side * direction[axis];
            if (cosine <= 0) continue;
            for (std::int32_t c = 0; c < 3; ++c)
                faces[(i * 6 + face) * 4 + c] += float(4 * light[c] * cosine * sent / share);
        }
    }
};

}  // namespace chiaro::kernel
