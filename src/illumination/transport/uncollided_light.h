// Light that no one has scattered yet: the probe's, through the matter on its way.
#pragma once
#include "core/lazy.h"
#include "illumination/transport/incident.h"
#include "illumination/transport/sweep.h"

namespace chiaro {

/// The grid as sweeps see it: opaque cells let all pass (their light is looked at and replaced) or, buried, nothing.
struct SweptMedium {
    const LightGrid& grid;
    const OpaqueCells& opaque;
    Lattices lattices;

    SweptMedium(const LightGrid& light_grid, const OpaqueCells& cells)
        : grid(light_grid), opaque(cells), lattices(light_grid.extinction.grid.count) {}
    /// For sweeps here; a GPU has its own.
    const BothWays& extinction() const {
        return extinction_([this] { return find_extinction(); });
    }

private:
    BothWays find_extinction() const;
    Lazy<BothWays> extinction_;
};

struct UncollidedLight {
    std::array<LatticeField, 3> light;                  ///< J per channel, rows along x
    std::array<std::array<LatticeField, 3>, 3> moment;  ///< [channel][axis]
    std::vector<OpaqueCells::Faces> faces;              ///< mean radiance on each face of the opaque cells
};

/// Each of a Fibonacci set of directions brings the mean radiance of its part of the probe; a sun goes along straight
/// rays of its own.
struct FirstDirections {
    std::vector<Vec3> directions;
    IncidentLight incident;

    FirstDirections(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, int count);
};

/// Throws Error{interrupted}.
UncollidedLight uncollided_light(const Device& device, const SweptMedium& medium, const FirstDirections& first,
                                 Progress& progress);

}  // namespace chiaro
