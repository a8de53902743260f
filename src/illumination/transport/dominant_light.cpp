#include "illumination/transport/dominant_light.h"

#include <cmath>
#include <numbers>

#include "core/threads.h"
#include "illumination/visibility/sweep.h"

namespace chiaro {

DominantLightKernels::DominantLightKernels(const SweptMedium& medium, const DominantLight& dominant)
    : share{}, faces{}, shine{} {
    const SweepGroup group = sweep_groups({dominant.direction})[0];
    const SweepBatch ray = sweep_batches({dominant.direction}, group, 1, 1, medium.opaque)[0];
    const kernel::CellPlaces places = cell_places(medium.lattices.along_x, medium.lattices.along_y);
    share.cells.places = faces.cells.places = shine.places = places;
    share.cells.open = faces.cells.open = std::sqrt(4 * std::numbers::pi);
    share.shown = std::int64_t(medium.opaque.count()), share.length = group.directions[0].length;
    faces.rays = ray.octants[0];
    std::copy_n(ray.rays[0].weight, 4, faces.weight);
    for (int i = 0; i < 3; ++i) {
        faces.light[i] = shine.colour[i] = dominant.light[i];
        faces.direction[i] = shine.direction[i] = dominant.direction[i];
    }
}

void DominantLightKernels::use(const Numbers& numbers) {
    share.cells.visibility = faces.cells.visibility = numbers.visibility;
    share.cells.clear = faces.cells.clear = numbers.clear;
    share.depth = numbers.depth, share.ids = numbers.ids, share.mean = numbers.mean;
    faces.nodes = numbers.nodes, faces.faces = numbers.faces, shine.mean = numbers.mean;
}

void add_dominant_light(const Device& device, const SweptMedium& medium, const DominantLight& dominant,
                        Progress& progress, UncollidedLight& light) {
    const Density& density = medium.grid.extinction;
    const OpaqueCells& opaque = medium.opaque;
    const ShField field = sweep_visibility(device, density, {dominant.direction}, dominant_coefficients, dominant_start,
                                           SweepLattice::sheared, progress);
    const std::vector<std::int32_t> ids = opaque.ids_with_halo();
    std::vector<double> mean(density.grid.size());
    DominantLightKernels kernels(medium, dominant);
    kernels.use({field.node(0), density.data(), opaque.clear_cells(), ids.data(), opaque.nodes().data(), mean.data(),
                 OpaqueCells::numbers(light.faces)});
    for (int c = 0; c < 3; ++c) {
        kernels.shine.light[c] = light.light[c].data();
        for (int axis = 0; axis < 3; ++axis) kernels.shine.moment[c][axis] = light.moment[c][axis].data();
    }
    const auto for_each = [&](std::size_t count, const auto& kernel) {
        parallel_for(device.threads, std::int64_t(count), 4096, [&](std::int64_t first, std::int64_t end) {
            for (std::int64_t i = first; i < end; ++i) kernel(i);
        });
    };
    for_each(opaque.count(), kernels.faces);
    for_each(mean.size(), kernels.share);
    for_each(mean.size(), kernels.shine);
}

}  // namespace chiaro
