// What light meets on its way: the medium on the light grid, found once and kept however it is lit.
#pragma once
#include "illumination/stage_timer.h"
#include "illumination/transport/light_fields.h"
#include "illumination/transport/nodes.h"

namespace chiaro {

struct TransportMedium {
    LightGrid grid;  ///< as light that scatters alike to all sides meets it
    OpaqueCells opaque;
    SweptMedium swept;
    std::vector<float> weight;                          ///< of each node (nodes.h)
    std::vector<std::array<float, 3>> boundary_albedo;  ///< of the grid's boundary cells
    Geometry geometry;                                  ///< of the volume
    bool counts_bounces;  ///< no cell is opaque then, for what those answer is all bounces at once

    TransportMedium(LightGrid light_grid, const Geometry& volume, bool counted, const Device& device);
    TransportMedium(const TransportMedium&) = delete;
    TransportMedium& operator=(const TransportMedium&) = delete;

    /// For sweeps here, rows along x; 0 in opaque cells.
    const Colour& albedo() const;
    /// What surfaces see of the light that no one has scattered yet, at the nodes of the finer grid; found once, and
    /// not again where `before`, other matter of the same volume, stops light alike. Throws Error{interrupted}.
    std::shared_ptr<const LitNodes> seen(const Device& device, StageTimer& timer, Progress& progress,
                                         const TransportMedium* before = nullptr) const;

private:
    /// What `seen` goes through.
    const Density& seen_through() const { return grid.finer ? *grid.finer : grid.extinction; }

    Lazy<Colour> albedo_;
    Lazy<std::shared_ptr<const LitNodes>> seen_;
};
using SharedTransportMedium = std::shared_ptr<const TransportMedium>;

/// On a grid of at most `cells`. Cost: that of `light_grid`. Throws Error{interrupted}, as `halved` does.
SharedTransportMedium matter_of(const Device& device, const Medium::Data& medium, int cells,
                                const ScatteringSettings& scattering, Progress& progress,
                                SurfaceModel surfaces = SurfaceModel::none);
/// The same matter on a grid half as fine, each cell of 2³: κ as in visibility/density.h, albedo weighted by it.
SharedTransportMedium halved(const SharedTransportMedium& finer, const Device& device, Progress& progress);
/// All that nodes tell but light.
TransportNodes unlit_nodes(const TransportMedium& matter);

}  // namespace chiaro
