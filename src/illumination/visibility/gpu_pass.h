// Sweeps on a GPU, in the places of grid_pass and sheared_pass: all batches of directions side by side, or as many as
// there is room for.
#pragma once
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

/// Add what arrives from all directions. Memory: two planes and a half of nodes × directions; and, where batches are
/// side by side, what all but one of them find (all, where the field is in steps): floats of the field once each.
/// Together half of what is free is taken at most, unless one batch takes more: 256³ nodes of 16 coefficients need 1.3
/// GiB at least, for the field above all.
void grid_sweep_on_gpu(const GpuField& field, const SweptDirections& directions, double start, Progress& progress);
void sheared_sweep_on_gpu(const GpuField& field, const SweptDirections& directions, double start, Progress& progress);

}  // namespace chiaro
