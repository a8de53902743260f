// Visibility as it is kept for pictures: in few bits.
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
    std::shared_ptr<const Density> density;  ///< what it was found from: a sun goes through it once more

    std::size_t bytes() const { return harmonics.size() + (density ? density->grid.size() * sizeof(float) : 0); }
    kernel::StoredHarmonics view() const { return {harmonics.data(), kernel::Stored(storage), coefficients}; }
    /// What a coefficient as it is kept is multiplied by.
    float step(int coefficient) const;
};

/// Without numbers yet: as many coefficients a node as there are, in the settings' storage.
VisibilityNodes make_nodes(const CellGrid& grid, int coefficients, const VisibilitySettings& settings);
/// What fills them from the field.
kernel::KeepKernel keep_kernel(VisibilityNodes& nodes, const float* field);

/// What adds to sums in steps.
kernel::AddSteps add_steps_kernel(int coefficients);

/// The field to be kept. Throws Error{interrupted}.
VisibilityNodes keep_nodes(const Device& device, const ShField& field, const VisibilitySettings& settings,
                           Progress& progress);
/// The same of sums in steps, in 8 bits: their memory is given back while that of what is kept is taken.
VisibilityNodes keep_nodes(const Device& device, ShSteps steps, const VisibilitySettings& settings, Progress& progress);

}  // namespace chiaro
