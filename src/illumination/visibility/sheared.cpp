#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/threads.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {
namespace {

/// The lattice of a direction on its way from plane to plane.
struct Lattice {
    double du, dv, a = 0, b = 0;

    /// Moves on by one plane; returns the shift of a ray's point in the plane before.
    std::pair<int, int> step() { return {step(a, du), step(b, dv)}; }

private:
    static int step(double& a, double slope) {
        const double moved = a - slope;
        a = moved - std::floor(moved);
        return -int(std::floor(moved));
    }
};

/// What travels from plane to plane.
class ShearedPlanes {
public:
    ShearedPlanes(int nu, int nv, int directions)
        : density_row_(nu + 2 + ShearedShape::padding),
          shape_(nu, nv),
          density_(std::size_t(density_row_) * std::size_t(nv + 2) + ShearedShape::padding) {
        for (auto& light : light_) light.assign(std::size_t(shape_.direction) * std::size_t(directions), 1);
    }

    int row() const { return shape_.row; }
    int density_row() const { return density_row_; }
    float* density() { return density_.data() + density_row_ + 1; }
    kernel::ShearedPlanes view(int k) {
        float *here = light_[k & 1].data() + shape_.origin(), *before = light_[(k + 1) & 1].data() + shape_.origin();
        return {density(), density_row_, before, here, shape_.row, shape_.direction};
    }

private:
    const int density_row_;
    const ShearedShape shape_;
    std::vector<float> density_, light_[2];
};

}  // namespace

std::vector<kernel::ShearedDirection> sheared_rays(std::span<const SweepDirection> batch, int planes, int row,
                                                   double start) {
    std::vector<Lattice> lattices;
    for (const SweepDirection& d : batch) lattices.push_back({d.du, d.dv});
    std::vector<kernel::ShearedDirection> rays;
    for (int k = 0; k < planes; ++k)
        for (std::size_t d = 0; d < batch.size(); ++d) {
            const auto [su, sv] = lattices[d].step();
            const double edges = -std::numbers::log2e * batch[d].length;
            rays.push_back({float(lattices[d].a), float(lattices[d].b), sv * row + su, float(edges),
                            float(edges * std::max(0.5 - start, 0.0))});
        }
    return rays;
}

void sheared_pass(const SweepPass& pass, const DirectionBatch& of, const std::function<void(double)>& tell) {
    const auto& [axes, batch] = of;
    const CellGrid& grid = pass.density.grid;
    const int nu = grid.count[axes.u], nv = grid.count[axes.v], steps = grid.count[axes.major];
    const BatchHarmonics harmonics(pass.directions, batch, pass.to.coefficients());
    const auto run = kernel::visibility_functions_for(pass.device.isa).sheared_row;
    ShearedPlanes planes(nu, nv, int(batch.size()));
    const std::vector<kernel::ShearedDirection> rays = sheared_rays(batch, steps, planes.row(), pass.start);
    for (int k = 0; k < steps; ++k) {
        const std::size_t plane = std::size_t(axes.sign > 0 ? steps - 1 - k : k) * pass.stride(axes.major);
        for (int v = 0; v < nv; ++v)
            for (int u = 0; u < nu; ++u)
                planes.density()[std::int64_t(v) * planes.density_row() + u] =
                    pass.density
                        .data()[plane + std::size_t(v) * pass.stride(axes.v) + std::size_t(u) * pass.stride(axes.u)];
        const kernel::ShearedKernel kernel{rays.data() + k * batch.size(), harmonics.view(), planes.view(k)};
        const auto rows = [&](std::int64_t first, std::int64_t end) {
            std::vector<float> scratch(batch.size() * kernel::ShearedKernel::width);
            RowAdder adder(pass, nu);
            for (auto r = first; r < end; ++r) {
                const int j = int(r) - 1;
                const auto row = [&](float* to, std::int64_t stride) {
                    run(kernel, {j, nu, to, stride, scratch.data()});
                };
                if (j < 0)
                    row(nullptr, 0);
                else
                    adder(plane + std::size_t(j) * pass.stride(axes.v), pass.stride(axes.u), row);
            }
        };
        parallel_for(pass.device.threads, nv + 1, std::max(1, nv / (4 * pass.device.threads)), rows);
        tell(double(k + 1) / steps);
    }
}

}  // namespace chiaro
