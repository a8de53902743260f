#include "illumination/transport/dominant_light.h"

#include <cmath>
#include <numbers>

#include "illumination/visibility/sweep.h"

namespace chiaro {

DominantLightKernels::DominantLightKernels(const SweptMedium& medium, const DominantLight& dominant)
    : share{}, faces{}, shine{} {
    const SweepGroup group = sweep_groups({dominant.direction})[0];
    const SweepBatch ray = sweep_batches({dominant.direction}, group, 1, 1)[0];
    const kernel::CellPlaces places = cell_places(medium.lattices.along_x, medium.lattices.along_y);
    share.cells.places = faces.cells.places = shine.places = places;
    share.cells.open = faces.cells.open = std::sqrt(4 * std::numbers::pi);
    share.shown = std::int64_t(medium.opaque.count()),
    share.cells.length = faces.cells.length = group.directions[0].length;
    faces.rays = ray.octants[0];
    std::copy_n(ray.rays[0].weight, 4, faces.weight);
    for (int i = 0; i < 3; ++i) {
        faces.light[i] = shine.colour[i] = dominant.light[i];
        faces.direction[i] = shine.direction[i] = dominant.direction[i];
    }
}

void add_dominant_light(const Device& device, const SweptMedium& medium, const DominantLight& dominant,
                        Progress& progress, UncollidedLight& light) {
    const Density& density = medium.grid.extinction;
    const OpaqueCells& opaque = medium.opaque;
    const ShField field = sweep_visibility(device, density, std::vector{dominant.direction}, dominant_coefficients,
                                           dominant_start, SweepLattice::sheared, progress);
    const std::vector<std::int32_t> ids = opaque.ids_with_halo();
    SunPlaces places{field.node(0),
                     density.data(),
                     opaque.clear_cells(),
                     ids.data(),
                     opaque.around().data(),
                     OpaqueCells::numbers(light.faces),
                     {},
                     {}};
    for (int c = 0; c < 3; ++c) {
        places.light[c] = light.light[c].data();
        for (int axis = 0; axis < 3; ++axis) places.moment[c][axis] = light.moment[c][axis].data();
    }
    CpuExecutor executor(device.threads, nullptr);
    shine(executor, medium, dominant, places);
}

}  // namespace chiaro
