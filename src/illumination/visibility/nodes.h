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
VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings);
/// What fills them from the field and, where they have surfaces, the opacity of their edges.
kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field, const float* opacity);

/// The field to be kept. VisibilityModel::corrected: each node that has a normal n = -(α(i + 1) - α(i - 1)) takes what
/// arrives one node edge along it (|n| shortened to 1; two edges where the surface is that far), and keeps n with q =
/// min(1, 4 |n|), the share that is a surface. Throws Error{interrupted}.
VisibilityNodes keep_nodes(const Device& device, const ShField& field, const Density& density,
                           const VisibilitySettings& settings, Progress& progress);

}  // namespace chiaro
