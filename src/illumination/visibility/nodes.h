// Visibility as it is kept for pictures: off the surfaces, in few bits, with the surfaces' normals.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include "illumination/visibility/density.h"
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/sh_field.h"

namespace chiaro {

/// What the light of any probe is found from.
struct VisibilityNodes {
    CellGrid grid;
    ShStorage storage;
    ShWindow window;   ///< for the light
    int coefficients;  ///< 4 or 16
    VoxelBuffer harmonics;
    VoxelBuffer surfaces;  ///< a kernel::NodeSurface a node; empty: light falls on particles everywhere

    std::size_t bytes() const { return harmonics.size() + surfaces.size(); }
    kernel::StoredHarmonics view() const { return {harmonics.data(), kernel::Stored(storage), coefficients}; }
    const kernel::NodeSurface* surface() const {
        return surfaces.size() ? reinterpret_cast<const kernel::NodeSurface*>(surfaces.data()) : nullptr;
    }
    /// What a coefficient as it is kept is multiplied by.
    float step(int coefficient) const;
};

/// Without numbers yet: as many coefficients a node as there are, in the settings' storage.
VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings, bool displaced);
/// What fills them from the field and, where they have surfaces, the opacity of their edges and their shares.
kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field, const float* opacity, const float* shares);

/// The field to be kept. With shares of surface (surface_share.h) each node that has a normal n = -(α(i + 1) -
/// α(i - 1)), and a surface near, of which q is the largest share, takes what arrives q node edges along it (|n|
/// shortened to 1; twice as far where the surface is that far), and keeps n with q min(1, 4 |n|), the share that is a
/// surface. Without: all are particles. Throws Error{interrupted}.
VisibilityNodes keep_nodes(const Device& device, const ShField& field, const Density& density, const Density* shares,
                           const VisibilitySettings& settings, Progress& progress);

}  // namespace chiaro
