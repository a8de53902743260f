// The light that an iteration changes and leaves, as the host has it.
#pragma once
#include "illumination/transport/uncollided_light.h"

namespace chiaro {

/// Three channels of a field.
using Colour = std::array<LatticeField, 3>;
inline Colour colour(const Lattice& lattice) { return {lattice.field(), lattice.field(), lattice.field()}; }

/// Rows along x.
struct LightFields {
    UncollidedLight first;
    Colour source, mean;
    std::array<Colour, 3> moment;                       ///< [channel][axis], running mean
    std::vector<OpaqueCells::Faces> faces, mean_faces;  ///< all the light on opaque cells' faces; its running mean
};

}  // namespace chiaro
