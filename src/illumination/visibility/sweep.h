// Visibility of all nodes by directional sweeps (docs/theory/visibility.md): beyond the paper, faster and more exact.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include "illumination/visibility/density.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/sh_field.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

/// Where the light of a direction is kept on its way: at the nodes, interpolated between them from plane to plane
/// (which blurs the shadows of thin things far away); or at points that follow its rays, and only then at the nodes.
enum class SweepLattice { grid, sheared };
inline SweepLattice lattice_of(VisibilityTraversal traversal) {
    return traversal == VisibilityTraversal::sheared ? SweepLattice::sheared : SweepLattice::grid;
}

/// V_lm of every node over the given directions, each weighing 4π / N, or means of V (SweptDirections).
/// V starts `start` node edges from a node (on a cube of that half edge; ½: at the border of its own). Cost: nodes ×
/// directions × some 1 ns of one core. Throws Error{interrupted} when cancelled.
ShField sweep_visibility(const Device& device, const Density& density, const SweptDirections& directions,
                         int coefficients, double start, SweepLattice lattice, Progress& progress);
/// The same by the CPU, in steps.
ShSteps sweep_in_steps(const Device& device, const Density& density, const SweptDirections& directions,
                       int coefficients, double start, SweepLattice lattice, Progress& progress);

/// On the device's GPU, where the field stays: floats, or steps, which can be kept in 8 bits alone.
GpuField sweep_on_gpu(const Device& device, const Density& density, const SweptDirections& directions, int coefficients,
                      double start, SweepLattice lattice, Progress& progress, bool in_steps = false);

}  // namespace chiaro
