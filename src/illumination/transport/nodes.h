// The light that transport leaves at the cells of its grid: what a picture is made from.
#pragma once
#include <vector>

#include "illumination/visibility/lit_nodes.h"

namespace chiaro {

/// Nodes at the centres of the grid's cells, x fastest. All radiance is relative to the probe's as it stands in
/// `Lighting` (turned, exposed): an empty volume under a white probe of 1 holds 1 everywhere.
struct TransportNodes {
    CellGrid grid;
    /// [node][3]: J, the mean radiance over the sphere per channel. A sample of matter sends albedo × J to the eye.
    /// In opaque cells what the open sides see, times R(a) / a: so that albedo × J is what an opaque half space
    /// reflects.
    std::vector<float> light;
    /// [node]: of this node where light is looked up between nodes, Σ w t J / Σ w t (t trilinear): 1 - exp(-κ), in (0,
    /// 1], small in air.
    std::vector<float> weight;
    /// [node][3][3]: per channel the first moment of radiance over the sphere, mean of I(ω) ω, ω towards the light, in
    /// the axes of the grid; no longer than J. From all around alike 0, from one direction J × that direction. The
    /// mean over the hemisphere about n is about J + 1.5 m · n, irradiance / π about J + 2 m · n.
    std::vector<float> moment;
    /// [node][3]: R(a) / a of cells that show a surface (opaque with a face in the open, or boundary_cells.h), 0 of all
    /// others; none where no cell is opaque.
    std::vector<float> result;
    /// [node][4][3]: J and first moment (x, y, z) of the light that matter has scattered, per channel; none where all
    /// are particles.
    std::vector<float> scattered;
    /// What surfaces see of the light that no one has scattered yet; none where all are particles.
    std::shared_ptr<const LitNodes> seen;
    int iterations = 0;  ///< sweeps of scattered light
    double change = 0;   ///< of J by the last one: relative RMS

    std::size_t bytes() const {
        const std::size_t numbers = light.size() + weight.size() + moment.size() + result.size() + scattered.size();
        return numbers * sizeof(float) + (seen ? seen->bytes() : 0);
    }
};

}  // namespace chiaro
