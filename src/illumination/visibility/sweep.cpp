#include "illumination/visibility/sweep.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/visibility/card_pass.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {
namespace {

constexpr std::size_t most_together = 80;

/// pass_batch(pass, axes, batch, tell) of all directions.
template <class PassBatch>
void sweep_batches(const SweepPass& pass, const PassBatch& pass_batch, Progress& progress) {
    std::size_t done = 0;
    for (const SweepGroup& group : sweep_groups(pass.directions))
        for (std::size_t first = 0; first < group.directions.size(); first += most_together) {
            const auto batch =
                std::span(group.directions).subspan(first, std::min(most_together, group.directions.size() - first));
            const auto tell = [&](double share) {
                progress.report("visibility",
                                (double(done) + share * double(batch.size())) / double(pass.directions.size()));
                progress.check();
            };
            pass_batch(pass, group.axes, batch, tell);
            done += batch.size();
        }
}

}  // namespace

void grid_pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
               const std::function<void(double)>& tell) {
    const CellGrid& grid = pass.density.grid;
    const int nu = grid.count[axes.u], nv = grid.count[axes.v], steps = grid.count[axes.major];
    const SweepPacks packs(batch, nu + 2, pass.start);
    const BatchHarmonics harmonics(pass.directions, batch, pass.field.coefficients);
    SweepPlanes planes(nu, nv, packs.lanes());
    const auto run = kernel::visibility_functions_for(pass.device.isa).sweep_row;
    for (int k = 0; k < steps; ++k) {
        const std::size_t plane = std::size_t(axes.sign > 0 ? steps - 1 - k : k) * pass.stride(axes.major);
        const kernel::SweepKernel kernel{packs.data(), harmonics.view(), planes.view(k)};
        const auto rows = [&](std::int64_t first, std::int64_t end) {
            std::vector<float> scratch(std::size_t(kernel::project_together) * std::size_t(packs.lanes()));
            for (auto v = first; v < end; ++v) {
                const std::size_t node = plane + std::size_t(v) * pass.stride(axes.v);
                run(kernel, {std::int32_t((v + 1) * planes.row() + 1), nu, pass.density.data() + node,
                             std::int64_t(pass.stride(axes.u)), pass.field.node(node),
                             std::int64_t(pass.stride(axes.u)) * pass.field.coefficients, scratch.data()});
            }
        };
        parallel_for(pass.device.threads, nv, std::max(1, nv / (4 * pass.device.threads)), rows);
        tell(double(k + 1) / steps);
    }
}

ShField sweep_visibility(const Device& device, const Density& density, const std::vector<Vec3>& directions,
                         int coefficients, double start, SweepLattice lattice, Progress& progress) {
    ShField field(density.grid, coefficients);
    const auto on_card = [&] {
        sweep_on_card(device, density, directions, coefficients, start, lattice, progress).fetch(field);
    };
    if (cuda::done_on_card(device, on_card)) return field;
    const SweepPass pass{device, density, directions, start, field};
    sweep_batches(pass, lattice == SweepLattice::grid ? grid_pass : sheared_pass, progress);
    return field;
}

CardField sweep_on_card(const Device& device, const Density& density, const std::vector<Vec3>& directions,
                        int coefficients, double start, SweepLattice lattice, Progress& progress) {
    CardField field(device, density, coefficients);
    ShField none(density.grid, coefficients);  // its pages are never touched
    const SweepPass pass{device, density, directions, start, none};
    const auto pass_batch = lattice == SweepLattice::grid ? grid_pass_on_card : sheared_pass_on_card;
    sweep_batches(
        pass, [&](const auto&... of_batch) { pass_batch(field, of_batch...); }, progress);
    return field;
}

}  // namespace chiaro
