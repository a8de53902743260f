#include "illumination/visibility/sweep.h"

#include <algorithm>

#include "core/threads.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep_plan.h"

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

class Sweep {
public:
    Sweep(const Device& device, const Density& density, const std::vector<Vec3>& directions, double start,
          ShField& field, Progress& progress)
        : device_(device),
          density_(density),
          directions_(directions),
          start_(start),
          field_(field),
          progress_(progress) {}

    void run() {
        const auto groups = sweep_groups(directions_);
        for (const SweepGroup& group : groups)
            for (std::size_t first = 0; first < group.directions.size(); first += most_together)
                take(group.axes, std::span(group.directions)
                                     .subspan(first, std::min(most_together, group.directions.size() - first)));
    }

private:
    static constexpr std::size_t most_together = 80;

    std::size_t stride(int axis) const {
        const auto& n = density_.grid.count;
        return axis == 0 ? 1 : axis == 1 ? std::size_t(n[0]) : std::size_t(n[0]) * n[1];
    }

    /// One batch of directions through all planes.
    void take(const SweepAxes& axes, std::span<const SweepDirection> batch) {
        const auto& n = density_.grid.count;
        const int nu = n[axes.u], nv = n[axes.v], steps = n[axes.major];
        const SweepPacks packs(batch, nu + 2, start_);
        const BatchHarmonics harmonics(directions_, batch, field_.coefficients);
        Planes planes(nu, nv, packs.lanes());
        const auto sweep_row = kernel::visibility_functions_for(device_.isa).sweep_row;
        for (int k = 0; k < steps; ++k) {
            const int plane = axes.sign > 0 ? steps - 1 - k : k;
            const kernel::SweepKernel kernel{packs.data(), harmonics.view(), planes.view(k)};
            const auto rows = [&](std::int64_t first, std::int64_t end) {
                std::vector<float> scratch(std::size_t(kernel::project_together) * packs.lanes());
                for (std::int64_t v = first; v < end; ++v) {
                    const std::size_t node = std::size_t(plane) * stride(axes.major) + std::size_t(v) * stride(axes.v);
                    sweep_row(kernel, {std::int32_t((v + 1) * planes.row() + 1), nu, density_.data() + node,
                                       std::int64_t(stride(axes.u)), field_.node(node),
                                       std::int64_t(stride(axes.u)) * field_.coefficients, scratch.data()});
                }
            };
            parallel_for(device_.threads, nv, std::max(1, nv / (4 * device_.threads)), rows);
            progress_.report("visibility",
                             (double(done_) + double(batch.size()) * (k + 1) / steps) / double(directions_.size()));
            progress_.check();
        }
        done_ += batch.size();
    }

    const Device& device_;
    const Density& density_;
    const std::vector<Vec3>& directions_;
    const double start_;
    ShField& field_;
    Progress& progress_;
    std::size_t done_ = 0;
};

}  // namespace

ShField sweep_visibility(const Device& device, const Density& density, const std::vector<Vec3>& directions,
                         int coefficients, double start, Progress& progress) {
    ShField field(density.grid, coefficients);
    Sweep(device, density, directions, start, field, progress).run();
    return field;
}

}  // namespace chiaro
