// One batch of directions on its way through all planes of a grid.
#pragma once
#include <functional>

#include "illumination/visibility/sweep.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

struct SweepPass {
    const Device& device;
    const Density& density;
    const std::vector<Vec3>& directions;  ///< all of them
    double start;
    ShField& field;  ///< to be added to

    std::size_t stride(int axis) const {
        const auto& n = density.grid.count;
        return axis == 0 ? 1 : axis == 1 ? std::size_t(n[0]) : std::size_t(n[0]) * n[1];
    }
};

/// Adds what arrives from the batch; `tell` hears of the share of planes done after each, and may throw.
void grid_pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
               const std::function<void(double)>& tell);
void sheared_pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
                  const std::function<void(double)>& tell);

}  // namespace chiaro
