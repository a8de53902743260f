// The published way to visibility: rays from every node through a pyramid, or step by step through its finest level.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include "illumination/sh/basis.h"
#include "illumination/stage_timer.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/pyramid.h"
#include "illumination/visibility/sh_field.h"

namespace chiaro {

/// V_lm of every node of the density, in the axes of its grid (Ritschel 2007), by `settings.traversal` (hierarchical or
/// full), `model`, `sampling`, `directions` and `bands`. V starts on a cube of half edge `start` node edges about a
/// node: ½ at its own border. Cost: nodes × directions × steps: 5 / s_0 + ln(n / 5) / ln 1.2, or n. Memory: the field
/// and 2.3 bytes a node. Throws Error{interrupted}.
ShField walk_visibility(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                        StageTimer& timer, Progress& progress);

/// On the device's GPU, where the field stays. Memory there: also the field and 2.3 bytes a node.
GpuField walk_on_gpu(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                     StageTimer& timer, Progress& progress);

/// Which way rays go, and how far at a time: the same for all nodes.
struct WalkPlan {
    CellGrid grid;
    double start;
    std::vector<kernel::WalkStep> steps;
    std::vector<std::vector<Vec3>> sets;  ///< of directions

    WalkPlan(const CellGrid& nodes, const VisibilitySettings& settings, double start);
    kernel::WalkKernel kernel(const kernel::PyramidLevel* levels, const kernel::WalkStep* steps) const;
    float weight() const;  ///< of a direction
};

/// The same for any nodes: the pyramid, the steps and the directions are made once.
class VisibilityWalk {
public:
    VisibilityWalk(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                   Progress& progress);

    /// V_lm of sixteen nodes along x, by coefficient; `first` and those behind it may lie beyond the row's end (no
    /// answer there).
    using Run = float[max_coefficients][kernel::LaneDirections::width];
    void operator()(int first, int y, int z, Run& harmonics) const;

private:
    const Device device_;
    const int coefficients_;
    const WalkPlan plan_;
    const TransparencyPyramid pyramid_;
    std::vector<kernel::LaneDirections> for_all_;  ///< where there is one set
};

}  // namespace chiaro
