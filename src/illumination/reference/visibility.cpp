#include "illumination/reference/visibility.h"

#include <numbers>

#include "core/threads.h"
#include "illumination/reference/crossings.h"
#include "illumination/reference/gpu.h"
#include "illumination/reference/interpolated.h"
#include "illumination/reference/launch.h"
#include "illumination/reference/reference.h"
#include "illumination/sh/directions.h"

namespace chiaro {
namespace {

using kernel::HarmonicSums;
using kernel::NodeRun;

constexpr int run_width = kernel::NodeColumn::width;
constexpr std::int64_t runs_at_a_time = 64;  ///< their sums stay in the cache, their directions are made once

/// The cell that holds a node's centre, and how far that lies off the cell's: half an edge where the node stands for
/// an even number of cells.
int cell_of(int node, int stride) { return node * stride + (stride - 1) / 2; }
Vec3 offset_of(int stride) {
    const double offset = stride % 2 ? 0 : 0.5;
    return {offset, offset, offset};
}

template <class Rays>
kernel::HarmonicsKernel<Rays> kernel_of(const Rays& rays, int stride, Vec3 direction) {
    kernel::HarmonicsKernel<Rays> kernel{rays, stride, {}};
    const auto y = spherical_harmonics(direction);
    std::copy(y.begin(), y.end(), kernel.harmonics);
    return kernel;
}

constexpr std::size_t runs_on_gpu = 1 << 16;  ///< 128 MB of sums

template <class Rays, class Follower, class Found>
void trace_on_gpu(cuda::Stream& stream, const std::vector<NodeRun>& runs, int stride,
                  const std::vector<Vec3>& directions, const Follower& follower, HostArrays arrays, Progress& progress,
                  const Found& found) {
    auto follow = follower();
    arrays.add(runs);
    cuda::Views medium(stream, std::move(arrays));
    const NodeRun* there = runs.data();
    medium.to_device_pointers(there);
    cuda::Array<HarmonicSums> sums(stream, std::min(runs_on_gpu, runs.size()));
    std::vector<HarmonicSums> landed(sums.size());
    for (std::size_t first = 0; first < runs.size(); first += sums.size()) {
        const std::size_t count = std::min(sums.size(), runs.size() - first);
        sums.zero();
        follow_on_gpu(stream, medium, follow, directions, progress, [&](const Rays& rays, Vec3 d) {
            kernel::trace_harmonics(stream, kernel_of(rays, stride, d), there + first, std::int64_t(count),
                                    sums.data());
        });
        stream.download(landed.data(), sums.data(), count * sizeof landed[0]);
        stream.wait();
        for (std::size_t i = 0; i < count; ++i) found(std::int64_t(first + i), landed[i]);
        progress.report("rays", double(first + count) / double(runs.size()));
    }
}

/// `follower()` makes, for a thread, the function from a direction to the rays that the kernel follows; `found(i,
/// sums)` receives Σ V Y of the runs.
template <class Rays, class Follower, class Found>
void trace(const Device& device, const std::vector<NodeRun>& runs, int stride, int rays, const Follower& follower,
           Progress& progress, const Found& found) {
    const auto directions = fibonacci_directions(rays);
    HostArrays arrays;
    follower().add_medium(arrays);
    const auto on_gpu = [&] {
        trace_on_gpu<Rays>(*device.stream, runs, stride, directions, follower, arrays, progress, found);
    };
    if (cuda::try_gpu(device, on_gpu)) return;
    arrays.fetch();
    const auto trace_runs = kernel::trace_runs_for<Rays>(device.isa);
    const auto work = [&](std::int64_t first, std::int64_t end) {
        auto follow = follower();
        std::vector<HarmonicSums> sums(std::size_t(end - first));
        for (const Vec3& d : directions) {
            if (progress.cancelled()) return;
            const auto kernel = kernel_of(follow(d), stride, d);
            trace_runs(kernel, runs.data() + first, int(end - first), sums.data());
        }
        for (auto i = first; i < end; ++i) found(i, sums[std::size_t(i - first)]);
    };
    parallel_for(device.threads, std::int64_t(runs.size()), runs_at_a_time, "rays", progress, work);
    progress.check();
}

/// From the sum over N directions to the integral over the sphere.
double weight_of(int rays) { return 4 * std::numbers::pi / rays; }

/// Rays through cells of constant extinction. Runs begin at the same place of their stride: one list of crossings
/// serves them all.
struct CellFollower {
    Crossings crossings;
    int stride;
    double start;
    kernel::CellRays operator()(Vec3 direction) {
        return crossings.along(direction, cell_of(0, stride), start, offset_of(stride));
    }
    void add_medium(HostArrays& arrays) const { crossings.cells().add_to(arrays); }
    void add_way(HostArrays& arrays) const { crossings.add_to(arrays); }
};
auto follower_of(const ExtinctionCells& cells, int stride, double start) {
    return [&cells, stride, start] { return CellFollower{Crossings(cells), stride, start}; };
}

/// Rays through the interpolated medium.
template <class Voxel>
struct InterpolatedFollower {
    const InterpolatedMedium<Voxel>& medium;
    int stride;
    double start;
    std::vector<kernel::HalfSpaceView> planes = {};
    kernel::InterpolatedRays<Voxel> operator()(Vec3 direction) {
        return medium.along(direction, start, planes, offset_of(stride));
    }
    void add_medium(HostArrays& arrays) const { medium.add_to(arrays); }
    void add_way(HostArrays& arrays) const { arrays.add(planes); }
};

/// Every node of the field, sixteen at a time.
std::vector<NodeRun> all_runs(const CellGrid& nodes, int stride, const ExtinctionCells* cells) {
    std::vector<NodeRun> runs;
    for (int z = 0; z < nodes.count[2]; ++z)
        for (int y = 0; y < nodes.count[1]; ++y)
            for (int x = 0; x < nodes.count[0]; x += run_width) {
                const int cell = cell_of(x, stride);
                runs.push_back({cell, cells ? cells->place(cell) : 0, cell_of(y, stride), cell_of(z, stride)});
            }
    return runs;
}

void keep(const HarmonicSums& sums, std::size_t run, double weight, ShField& out) {
    const std::size_t per_row = std::size_t(out.grid.count[0] + run_width - 1) / run_width;
    const int x = int(run % per_row) * run_width;
    for (int i = 0; i < std::min(run_width, out.grid.count[0] - x); ++i) {
        float* to = out.node(run / per_row * std::size_t(out.grid.count[0]) + std::size_t(x + i));
        for (int c = 0; c < max_coefficients; ++c) to[c] = float(weight * sums.at[c][i]);
    }
}

}  // namespace

ShField reference_visibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                             const ReferenceSettings& settings, StageTimer& timer, Progress& progress) {
    const int stride = settings.subsample;
    const double start = settings.start_half_voxels;
    ShField out(coarser(opacity.values.grid, stride), max_coefficients);
    const auto found = [&](std::int64_t run, const HarmonicSums& sums) {
        keep(sums, std::size_t(run), weight_of(settings.rays), out);
    };
    const auto through_cells = [&] {
        const ExtinctionCells cells =
            timer("extinction", [&] { return ExtinctionCells(medium, opacity, stride, device, progress); });
        const auto runs = all_runs(out.grid, stride, &cells);
        timer("rays", [&] {
            trace<kernel::CellRays>(device, runs, stride, settings.rays, follower_of(cells, stride, start), progress,
                                    found);
        });
    };
    const auto through_voxels = [&](auto voxel) {
        using Voxel = decltype(voxel);
        const InterpolatedMedium<Voxel> interpolated(medium, opacity.values.grid, reference_step);
        const auto follower = [&] { return InterpolatedFollower<Voxel>{interpolated, stride, start}; };
        const auto runs = all_runs(out.grid, stride, nullptr);
        timer("rays", [&] {
            trace<kernel::InterpolatedRays<Voxel>>(device, runs, stride, settings.rays, follower, progress, found);
        });
    };
    if (settings.medium == ReferenceMedium::voxels)
        through_cells();
    else
        with_stored_voxel(medium.volume.data(), through_voxels);
    return out;
}

std::vector<RunHarmonics> trace_harmonics(const Device& device, const ExtinctionCells& cells, int stride,
                                          double start_half_voxels, int rays,
                                          const std::vector<std::array<int, 3>>& first_nodes, Progress& progress) {
    std::vector<NodeRun> runs;
    for (const auto& [x, y, z] : first_nodes)
        runs.push_back({cell_of(x, stride), cells.place(cell_of(x, stride)), cell_of(y, stride), cell_of(z, stride)});
    std::vector<RunHarmonics> harmonics(runs.size());
    const auto found = [&](std::int64_t run, const HarmonicSums& sums) {
        for (int c = 0; c < max_coefficients; ++c)
            for (int i = 0; i < run_width; ++i) harmonics[std::size_t(run)][c][i] = weight_of(rays) * sums.at[c][i];
    };
    trace<kernel::CellRays>(device, runs, stride, rays, follower_of(cells, stride, start_half_voxels), progress, found);
    return harmonics;
}

}  // namespace chiaro
