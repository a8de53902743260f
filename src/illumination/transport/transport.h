// Light by transport, from a first coarse field to a converged one.
#pragma once
#include <functional>

#include "illumination/steps.h"
#include "illumination/transport/solver.h"

namespace chiaro {

/// What a change of the medium leaves to start from; empty at first. `refine_transport` renews it.
using TransportMemory = std::shared_ptr<const TransportSolver>;

/// Hands light to `keep`: of a grid half as fine after its first iterations, then of the grid asked for after the
/// first few and after each further one; all but the last are coarse. Throws Error{interrupted}: what was kept before
/// stays valid.
void refine_transport(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                      const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                      const std::function<void(TransportNodes, bool is_coarse)>& keep, Steps& steps, Progress& progress,
                      TransportMemory* memory = nullptr);

}  // namespace chiaro
