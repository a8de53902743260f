// Light by transport, from a first coarse field to a converged one.
#pragma once
#include <functional>

#include "illumination/stage_timer.h"
#include "illumination/transport/solver.h"

namespace chiaro {

/// What one change leaves for the next; nothing at first. `refine_transport` renews it.
struct TransportMemory {
    std::shared_ptr<const TransportSolver> fine, half;  ///< the same light on the grid asked for, and half as fine
    std::weak_ptr<const Medium::Data> medium;
    std::weak_ptr<const DeviceVolume::Data> volume;
    int grid = 0;
    ScatteringSettings scattering;
    SurfaceModel surfaces = SurfaceModel::none;

    /// Whether its matter need not be found again, however it is lit.
    bool is_of(const Medium::Data& medium, const TransportSettings& settings, const ScatteringSettings& how,
               SurfaceModel shown) const;
};

/// Hands light to `keep`: of a grid half as fine after its first iterations - where there was light before, with the
/// detail that this had -, then of the grid asked for after the first few and after each further one; all but the last
/// are coarse. Throws Error{interrupted}: what was kept before stays valid.
void refine_transport(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                      const TransportSettings& settings, const ScatteringSettings& scattering, SurfaceModel surfaces,
                      Vec3 orbit_up, const std::function<void(TransportNodes, bool is_coarse)>& keep, StageTimer& timer,
                      Progress& progress, TransportMemory* memory = nullptr);

}  // namespace chiaro
