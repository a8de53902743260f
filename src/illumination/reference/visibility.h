// Visibility in spherical harmonics by brute force: what sweeps and pyramids are measured against.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include "illumination/reference/extinction.h"
#include "illumination/sh/basis.h"
#include "illumination/stage_timer.h"
#include "illumination/visibility/sh_field.h"

namespace chiaro {

/// V_lm = (4π/N) Σ V(x, ω_i) Y_lm(ω_i) at every node, by rays in N Fibonacci directions; 16 coefficients, axes of the
/// grid. `settings.subsample` makes one node of so many cells per axis, at their centre; rays still cross the cells.
/// Rays begin on the cube of `start_half_voxels` half voxel widths about the node. Cost: rays × cells crossed.
ShField reference_visibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                             const ReferenceSettings& settings, StageTimer& timer, Progress& progress);

/// Sixteen nodes along x, by coefficient.
using RunHarmonics = std::array<std::array<double, 16>, max_coefficients>;

/// The same for the runs of sixteen nodes that begin at the given ones, through cells made with the same `stride`: a
/// node stands for stride³ cells. Nodes beyond the end of a row hold no answer.
std::vector<RunHarmonics> trace_harmonics(const Device& device, const ExtinctionCells& cells, int stride,
                                          double start_half_voxels, int rays,
                                          const std::vector<std::array<int, 3>>& first_nodes, Progress& progress);

}  // namespace chiaro
