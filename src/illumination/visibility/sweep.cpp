#include "illumination/visibility/sweep.h"

#include <algorithm>

#include "core/line_allocator.h"
#include "core/threads.h"
#include "illumination/visibility/gpu_pass.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {
namespace {

/// What travels from plane to plane: two planes of nodes with a halo of one, where all light arrives.
class SweepPlanes {
public:
    SweepPlanes(int nu, int nv, int packs) : row_(nu + 2), packs_(packs) {
        const std::size_t nodes = std::size_t(row_) * std::size_t(nv + 2);
        for (Plane& plane : planes_) {
            plane.density.assign(nodes, 0);
            plane.light.assign(nodes * std::size_t(packs) * kernel::SweepPack::width, 1);
            plane.state.assign(nodes, kernel::clear | kernel::empty);
        }
    }
    int row() const { return row_; }
    kernel::SweepPlanes view(int k) {
        Plane &last = planes_[(k + 1) & 1], &next = planes_[k & 1];
        return {last.density.data(),
                next.density.data(),
                last.light.data(),
                next.light.data(),
                last.state.data(),
                next.state.data(),
                row_,
                packs_};
    }

private:
    struct Plane {
        std::vector<float> density;
        LineVector<float> light;
        std::vector<std::uint8_t> state;
    };
    Plane planes_[2];
    int row_, packs_;
};

}  // namespace

RowAdder::RowAdder(const SweepPass& pass, int count)
    : to_(pass.to),
      count_(count),
      parts_(to_.steps ? std::size_t(count) * std::size_t(to_.coefficients()) : 0, 0),
      kernel_(add_steps_kernel(to_.coefficients())),
      add_(kernel::visibility_functions_for(pass.device.isa).add_steps) {}

void grid_pass(const SweepPass& pass, const DirectionBatch& of, const std::function<void(double)>& tell) {
    const auto& [axes, batch] = of;
    const CellGrid& grid = pass.density.grid;
    const int nu = grid.count[axes.u], nv = grid.count[axes.v], steps = grid.count[axes.major];
    const SweepPacks packs(batch, nu + 2, pass.start);
    const BatchHarmonics harmonics(pass.directions, batch, pass.to.coefficients());
    SweepPlanes planes(nu, nv, packs.count());
    const auto run = kernel::visibility_functions_for(pass.device.isa).sweep_row;
    for (int k = 0; k < steps; ++k) {
        const std::size_t plane = std::size_t(axes.sign > 0 ? steps - 1 - k : k) * pass.stride(axes.major);
        const kernel::SweepKernel kernel{packs.data(), harmonics.view(), planes.view(k)};
        const auto rows = [&](std::int64_t first, std::int64_t end) {
            LineVector<float> scratch(std::size_t(kernel::sweep_together) * std::size_t(packs.lanes()));
            RowAdder adder(pass, nu);
            for (auto v = first; v < end; ++v) {
                const std::size_t node = plane + std::size_t(v) * pass.stride(axes.v), stride = pass.stride(axes.u);
                adder(node, stride, [&](float* to, std::int64_t to_stride) {
                    run(kernel, {std::int32_t((v + 1) * planes.row() + 1), nu, pass.density.data() + node,
                                 std::int64_t(stride), to, to_stride, scratch.data()});
                });
            }
        };
        parallel_for(pass.device.threads, nv, std::max(1, nv / (4 * pass.device.threads)), rows);
        tell(double(k + 1) / steps);
    }
}

namespace {

void pass_all(const SweepPass& pass, SweepLattice lattice, Progress& progress) {
    const auto pass_batch = lattice == SweepLattice::grid ? grid_pass : sheared_pass;
    const std::vector<SweepGroup> groups = sweep_groups(pass.directions.towards);
    std::size_t done = 0;
    for (const DirectionBatch& batch : direction_batches(groups)) {
        const double count = double(batch.directions.size());
        pass_batch(pass, batch, [&](double share) {
            progress.report("visibility", (double(done) + share * count) / double(pass.directions.towards.size()));
            progress.check();
        });
        done += batch.directions.size();
    }
}

}  // namespace

ShField sweep_visibility(const Device& device, const Density& density, const SweptDirections& directions,
                         int coefficients, double start, SweepLattice lattice, Progress& progress) {
    ShField field(density.grid, coefficients);
    const auto on_gpu = [&] {
        sweep_on_gpu(device, density, directions, coefficients, start, lattice, progress).fetch(field);
    };
    if (cuda::try_gpu(device, on_gpu)) return field;
    pass_all({device, density, directions, start, {.floats = &field}}, lattice, progress);
    return field;
}

ShSteps sweep_in_steps(const Device& device, const Density& density, const SweptDirections& directions,
                       int coefficients, double start, SweepLattice lattice, Progress& progress) {
    ShSteps steps(density.grid, coefficients);
    pass_all({device, density, directions, start, {.steps = &steps}}, lattice, progress);
    return steps;
}

GpuField sweep_on_gpu(const Device& device, const Density& density, const SweptDirections& directions, int coefficients,
                      double start, SweepLattice lattice, Progress& progress, bool in_steps) {
    GpuField field(device, density, coefficients, in_steps);
    const auto sweep = lattice == SweepLattice::grid ? grid_sweep_on_gpu : sheared_sweep_on_gpu;
    sweep(field, directions, start, progress);
    return field;
}

}  // namespace chiaro
