// One batch of directions on its way through all planes of a grid.
#pragma once
#include <functional>

#include "core/line_allocator.h"
#include "illumination/visibility/sheared_kernel.h"
#include "illumination/visibility/sweep.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

/// Numbers that a pass adds to: one of the two.
struct SweptNumbers {
    ShField* floats = nullptr;
    ShSteps* steps = nullptr;
    int coefficients() const { return floats ? floats->coefficients : steps->coefficients; }
};

struct SweepPass {
    const Device& device;
    const Density& density;
    const SweptDirections& directions;  ///< all of them
    double start;
    SweptNumbers to;

    std::size_t stride(int axis) const {
        const auto& n = density.grid.count;
        return axis == 0 ? 1 : axis == 1 ? std::size_t(n[0]) : std::size_t(n[0]) * n[1];
    }
};

/// Rows of so many nodes, one after the other, to be added to by a kernel that adds floats.
class RowAdder {
public:
    RowAdder(const SweepPass& pass, int count);
    /// add(numbers of the row's first node, stride from one node to the next).
    template <class Add>
    void operator()(std::size_t node, std::size_t node_stride, const Add& add) {
        const int coefficients = to_.coefficients();
        const auto stride = std::int64_t(node_stride) * coefficients;
        if (to_.floats) return add(to_.floats->node(node), stride);
        add(parts_.data(), std::int64_t(coefficients));
        add_(kernel_, parts_.data(), count_, to_.steps->node(node), stride);
    }

private:
    const SweptNumbers to_;
    const int count_;
    LineVector<float> parts_;  ///< 0 between rows
    kernel::AddSteps kernel_;
    void (*const add_)(const kernel::AddSteps&, float*, std::int32_t, std::uint16_t*, std::int64_t);
};

/// Adds what arrives from the batch; `tell` hears of the share of planes done after each, and may throw.
void grid_pass(const SweepPass& pass, const DirectionBatch& batch, const std::function<void(double)>& tell);
void sheared_pass(const SweepPass& pass, const DirectionBatch& batch, const std::function<void(double)>& tell);

/// How the points of a batch's lattices lie in memory: padded, so that sixteen numbers can be read and written from any
/// point on.
struct ShearedShape {
    static constexpr int padding = kernel::ShearedKernel::width;
    int row;
    std::int64_t direction;  ///< from one direction's points to the next one's

    ShearedShape(int nu, int nv) : row(nu + 3 + padding), direction(std::int64_t(row) * (nv + 3) + padding) {}
    int origin() const { return 2 * row + 2; }  ///< point (0, 0)
};

/// Where the rays of a batch lie in each plane: [plane][direction].
std::vector<kernel::ShearedDirection> sheared_rays(std::span<const SweepDirection> batch, int planes, int row,
                                                   double start);

}  // namespace chiaro
