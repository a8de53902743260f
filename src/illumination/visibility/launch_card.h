// The kernels of visibility as a card has them, compiled by launch_*.cu.
#pragma once
#include "cuda/run.h"
#include "illumination/visibility/density_kernel.h"
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/pyramid_kernel.h"
#include "illumination/visibility/sheared_kernel.h"
#include "illumination/visibility/sweep_kernel.h"
#include "illumination/visibility/walk_kernel.h"

namespace chiaro::kernel {

/// A plane of nodes; pointers are the card's.
struct SweptPlane {
    std::int32_t nu, nv;
    std::int64_t stride_u, stride_v;  ///< nodes of the grid
    const float* density;             ///< of the plane's first node in the grid
    float* field;                     ///< its coefficients
    float* scratch;                   ///< [v][u][direction]; of sheared lattices [direction][v][u]
};

/// A thread for each node: within a plane none needs another.
void sweep_plane(cuda::Stream& stream, const SweepKernel& kernel, const SweptPlane& plane);

/// A thread for each point of the lattices, then for each node. `density`: the kernel's, to be filled first.
void sweep_sheared_plane(cuda::Stream& stream, const ShearedKernel& kernel, const SweptPlane& plane, float* density);

void find_opacities(cuda::Stream& stream, const OpacityKernel& kernel, std::int64_t nodes);
void keep_all_nodes(cuda::Stream& stream, const KeepKernel& kernel);
void light_all_nodes(cuda::Stream& stream, const LightKernel& kernel, std::int64_t nodes);

}  // namespace chiaro::kernel
