#include "illumination/visibility/sweep.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {
namespace {

/// What travels from plane to plane: two planes of nodes with a halo of one, where all light arrives.
class Planes {
public:
    Planes(int nu, int nv, int directions) : row_(nu + 2), directions_(directions) {
        const std::size_t nodes = std::size_t(row_) * std::size_t(nv + 2);
        for (Plane& plane : planes_) {
            plane.density.assign(nodes, 0);
            plane.light.assign(nodes * std::size_t(directions), 1);
            plane.state.assign(nodes, kernel::clear | kernel::empty);
        }
    }
    int row() const { return row_; }
    /// After so many planes.
    kernel::SweepPlanes view(int k) {
        Plane &before = planes_[(k + 1) & 1], &here = planes_[k & 1];
        return {before.density.data(),
                here.density.data(),
                before.light.data(),
                here.light.data(),
                before.state.data(),
                here.state.data(),
                row_,
                directions_};
    }

private:
    struct Plane {
        std::vector<float> density, light;
        std::vector<std::uint8_t> state;
    };
    Plane planes_[2];
    int row_, directions_;
};

constexpr std::size_t most_together = 80;

}  // namespace

void grid_pass(const SweepPass& pass, const SweepAxes& axes, std::span<const SweepDirection> batch,
               const std::function<void(double)>& tell) {
    const CellGrid& grid = pass.density.grid;
    const int nu = grid.count[axes.u], nv = grid.count[axes.v], steps = grid.count[axes.major];
    const SweepPacks packs(batch, nu + 2, pass.start);
    const BatchHarmonics harmonics(pass.directions, batch, pass.field.coefficients);
    Planes planes(nu, nv, packs.lanes());
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
    const SweepPass pass{device, density, directions, start, field};
    std::size_t done = 0;
    for (const SweepGroup& group : sweep_groups(directions))
        for (std::size_t first = 0; first < group.directions.size(); first += most_together) {
            const auto batch =
                std::span(group.directions).subspan(first, std::min(most_together, group.directions.size() - first));
            const auto tell = [&](double share) {
                progress.report("visibility",
                                (double(done) + share * double(batch.size())) / double(directions.size()));
                progress.check();
            };
            (lattice == SweepLattice::grid ? grid_pass : sheared_pass)(pass, group.axes, batch, tell);
            done += batch.size();
        }
    return field;
}

}  // namespace chiaro
