#include "illumination/transport/first_light.h"

#include <cmath>
#include <numbers>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/batches.h"
#include "illumination/transport/launch.h"
#include "illumination/transport/matter_kernel.h"
#include "illumination/visibility/sweep.h"

namespace chiaro {
namespace {

using Kernel = kernel::FirstSweepKernel;
using Sums = std::array<LatticeField, Kernel::sums>;
using Arriving = std::span<float>;  ///< [cell][face][4]

/// All directions of one group, in batches whose planes stay in the cache.
class GroupSweep {
public:
    GroupSweep(const Device& device, const SweptMedium& medium, const std::vector<Vec3>& directions,
               const IncidentLight& incident, Progress& progress)
        : run_(kernel::transport_functions_for(device.isa).first_row),
          medium_(medium),
          directions_(directions),
          incident_(incident),
          progress_(progress) {}

    void operator()(const SweepGroup& group, Sums& sums, Arriving arriving) const {
        const Lattice& lattice = medium_.lattices.of(group.axes);
        for (auto& field : sums) field = lattice.unset_field();
        std::fill(arriving.begin(), arriving.end(), 0.0f);
        TravellingPlanes planes(lattice.count()[group.axes.u], lattice.count()[group.axes.v], Kernel::most_rays);
        bool is_first = true;
        for (SweepBatch& batch : sweep_batches(directions_, group, Kernel::most_rays, planes.field(), medium_.opaque)) {
            sweep(group.axes, FirstBatch(std::move(batch), directions_, incident_), is_first, planes, sums, arriving);
            is_first = false;
        }
    }

private:
    void sweep(const SweepAxes& axes, const FirstBatch& batch, bool is_first, TravellingPlanes& planes, Sums& sums,
               Arriving arriving) const {
        const Lattice& lattice = medium_.lattices.of(axes);
        Kernel kernel = batch.kernel(is_first);
        planes.start(batch.count(), 1);
        for_each_row(lattice, axes, medium_.opaque, nullptr, arriving.data(), progress_, planes,
                     [&](const kernel::SweepPlane& plane, const SweptRow& row) {
                         kernel.plane = plane;
                         kernel::FirstSweepRow to{planes.place(row.v),
                                                  lattice.count()[axes.u],
                                                  medium_.extinction().of(axes) + row.at,
                                                  {},
                                                  row.opaque};
                         ask_for(row.opaque, batch.octants),
                             ask_for(medium_.extinction().of(axes) + row.next, to.count);
                         for (int s = 0; s < Kernel::sums; ++s) {
                             to.sums[s] = sums[s].data() + row.at;
                             ask_for(sums[s].data() + row.next, to.count);
                         }
                         run_(kernel, to);
                     });
    }

    void (*run_)(const Kernel&, const kernel::FirstSweepRow&);
    const SweptMedium& medium_;
    const std::vector<Vec3>& directions_;
    const IncidentLight& incident_;
    Progress& progress_;
};

/// Adds the groups' sums of a slice in a fixed order, so that it does not matter who found them.
void add_slice(const Lattices& lattices, const std::vector<SweepGroup>& groups, const std::vector<Sums>& parts, int s,
               int z, LatticeField& turned, float* to) {
    const std::size_t slice = turned.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const float* from = parts[g][s].data() + std::size_t(z) * slice;
        if (groups[g].axes.major == 0) {
            copy_slice(lattices.along_y, parts[g][s].data(), lattices.along_x, turned.data() - z * slice, z);
            from = turned.data();
        }
        for (std::size_t i = 0; i < slice; ++i) to[i] = g == 0 ? from[i] : to[i] + from[i];
    }
}

/// All groups together; a moment per channel from that of luminance: colour and direction of what arrives are told
/// apart.
void add_up(const Device& device, const Lattices& lattices, const std::vector<SweepGroup>& groups,
            const std::vector<Sums>& parts, FirstLight& light) {
    const Lattice& along_x = lattices.along_x;
    for (auto& field : light.light) field = along_x.unset_field();
    for (auto& channel : light.moment)
        for (auto& field : channel) field = along_x.unset_field();
    const std::size_t slice = std::size_t(along_x.row()) * std::size_t(along_x.count()[1]);
    const float weights[]{float(luminance_weights[0]), float(luminance_weights[1]), float(luminance_weights[2])};
    parallel_for(device.threads, along_x.count()[2], 1, [&](std::int64_t z, std::int64_t) {
        LatticeField turned(slice, 0.0f), moment[3];
        std::array<float*, 3> j;
        for (int c = 0; c < 3; ++c) {
            j[c] = light.light[c].data() + std::size_t(z) * slice;
            add_slice(lattices, groups, parts, c, int(z), turned, j[c]);
            moment[c].resize(slice);
            add_slice(lattices, groups, parts, 3 + c, int(z), turned, moment[c].data());
        }
        LatticeField per_luminance(slice);
        for (std::size_t i = 0; i < slice; ++i)
            per_luminance[i] = kernel::inverse_luminance(weights, j[0][i], j[1][i], j[2][i]);
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis) {
                float* to = light.moment[c][axis].data() + std::size_t(z) * slice;
                const float *of = moment[axis].data(), *own = j[c];
                for (std::size_t i = 0; i < slice; ++i) to[i] = kernel::moment_of(of[i], own[i], per_luminance[i]);
            }
    });
}

}  // namespace

BothWays SweptMedium::find_extinction() const {
    const CellGrid& nodes = grid.extinction.grid;
    std::vector<float> swept(grid.extinction.data(), grid.extinction.data() + nodes.size());
    for (std::size_t node = 0; node < swept.size(); ++node)
        swept[node] = kernel::swept_depth(swept[node], opaque.is_opaque(node), opaque.is_listed(node));
    return {spread(nodes, swept.data(), lattices.along_x), spread(nodes, swept.data(), lattices.along_y)};
}

FirstDirections::FirstDirections(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, int count)
    : directions(fibonacci_directions(count)), incident(incident_light(lighting, orbit_up, geometry, directions)) {}

/// Along straight rays: what arrives at a cell's border, and what of it is left behind the cell.
SunLight::SunLight(const Device& device, const SweptMedium& medium, const Sun& the_sun, Progress& progress,
                   std::vector<OpaqueCells::Faces>& faces)
    : sun(the_sun), mean(medium.grid.extinction.grid.size(), -1) {
    const Density& density = medium.grid.extinction;
    const ShField field = sweep_visibility(device, density, {sun.direction}, 4, 0.5, SweepLattice::sheared, progress);
    const SweepGroup group = sweep_groups({sun.direction})[0];
    const SweepBatch ray = sweep_batches({sun.direction}, group, 1, 1, medium.opaque)[0];
    const double all = std::sqrt(4 * std::numbers::pi);  // V_00 in the open
    const auto arriving = [&](std::size_t node) { return field.node(node)[0] / all; };
    for (std::size_t node = 0; node < mean.size(); ++node) {
        const double depth = medium.opaque.is_opaque(node) ? 0 : density.data()[node];
        if (medium.opaque.is_buried(node)) continue;
        mean[node] = arriving(node) * (1 + std::exp(-depth * group.directions[0].length)) / 2;
    }
    const auto [nx, ny, nz] = density.grid.count;
    for (std::size_t cell = 0; cell < medium.opaque.count(); ++cell) {
        const std::size_t node = medium.opaque.nodes()[cell];
        const int x = int(node % nx), y = int(node / nx % ny), z = int(node / nx / ny);
        const kernel::OpaqueRow at{.clear = medium.opaque.clear_cells() + medium.opaque.bit_index(x, y, z)};
        const float share = ray.open_share(0, at.pattern(ray.octants[0], {}));
        if (share < kernel::least_open) continue;
        for (int axis = 0; axis < 3; ++axis)
            for (int c = 0; c < 3; ++c)  // irradiance / π, light being ∫ L dω / 4π
                faces[cell][2 * axis + (sun.direction[axis] < 0)][c] +=
                    float(4 * sun.light[c] * std::abs(sun.direction[axis]) * std::min(arriving(node) / share, 1.0));
    }
}

kernel::SunKernel SunLight::kernel(const Lattices& lattices) const {
    kernel::SunKernel kernel{cell_places(lattices.along_x, lattices.along_y), {}, {}, mean.data(), {}, {}};
    for (int c = 0; c < 3; ++c) kernel.colour[c] = sun.light[c], kernel.direction[c] = sun.direction[c];
    return kernel;
}

FirstLight first_light(const Device& device, const SweptMedium& medium, const FirstDirections& first,
                       Progress& progress) {
    const std::vector<SweepGroup> groups = sweep_groups(first.directions);
    const std::size_t face_count = medium.opaque.count() * OpaqueCells::faces, faces = 4 * face_count;
    std::vector<Sums> sums(groups.size());
    LatticeField arriving(groups.size() * faces);
    const GroupSweep sweep(device, medium, first.directions, first.incident, progress);
    parallel_for(device.threads, std::int64_t(groups.size()), 1, "light", progress, [&](std::int64_t g, std::int64_t) {
        sweep(groups[g], sums[g], std::span(arriving).subspan(std::size_t(g) * faces, faces));
    });
    progress.check();
    FirstLight light{{}, {}, std::vector<OpaqueCells::Faces>(medium.opaque.count())};
    const kernel::FaceKernel meet{arriving.data(),
                                  std::int64_t(faces),
                                  std::int32_t(groups.size()),
                                  nullptr,
                                  OpaqueCells::numbers(light.faces),
                                  nullptr,
                                  0};
    for (std::size_t face = 0; face < face_count; ++face) meet(std::int64_t(face));
    add_up(device, medium.lattices, groups, sums, light);
    if (!first.incident.sun) return light;
    const SunLight sun(device, medium, *first.incident.sun, progress, light.faces);
    kernel::SunKernel shine = sun.kernel(medium.lattices);
    for (int c = 0; c < 3; ++c) {
        shine.light[c] = light.light[c].data();
        for (int axis = 0; axis < 3; ++axis) shine.moment[c][axis] = light.moment[c][axis].data();
    }
    const auto [nx, ny, nz] = medium.grid.extinction.grid.count;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                shine.shine(std::int64_t(medium.grid.extinction.grid.index(x, y, z)),
                            std::int64_t(medium.lattices.along_x.index(x, y, z)));
    return light;
}

}  // namespace chiaro
