// Multiple scattering by iterated sweeps (docs/theory/transport.md).
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>
#include <chiaro/progress.h>

#include <memory>

#include "classify/medium.h"
#include "illumination/transport/matter.h"
#include "illumination/transport/nodes.h"

namespace chiaro {

/// Light on its way through a medium, one iteration after the other. Cheap to move, not to be copied.
class TransportSolver {
public:
    /// Finds the uncollided light. `warm`: light in a similar medium, of the same or another grid, from which
    /// scattering starts. Throws Error{interrupted}.
    TransportSolver(const Device& device, SharedTransportMedium matter, const Lighting& lighting,
                    const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                    Progress& progress, const TransportNodes* warm = nullptr);
    /// Of a medium, on the light grid of the settings.
    TransportSolver(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                    const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                    Progress& progress, const TransportNodes* warm = nullptr);
    TransportSolver(TransportSolver&&) noexcept;
    TransportSolver& operator=(TransportSolver&&) noexcept;
    ~TransportSolver();

    /// One more sweep of scattered light; false, and nothing done, when there is nothing more to do: all bounces asked
    /// for are there, or the last iterations changed the light by less than asked. Throws Error{interrupted}; the
    /// solver is then as it was before the call.
    bool iterate(Progress& progress);
    /// Whether there is nothing more to do.
    bool is_done() const;
    /// `surfaces`: scattered light apart, too.
    TransportNodes nodes(SurfaceModel surfaces = SurfaceModel::none) const;

    const SharedTransportMedium& matter() const;
    int iterations() const;
    double change() const;  ///< of J by the last iteration: relative RMS
    struct State;

private:
    std::unique_ptr<State> state_;
};

}  // namespace chiaro
