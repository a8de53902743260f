#include "illumination/transport/uncollided_light.h"

#include <cmath>
#include <numbers>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/batches.h"
#include "illumination/transport/dominant_light.h"
#include "illumination/transport/launch.h"
#include "illumination/transport/matter_kernel.h"

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
        TravellingPlanes planes(lattice.count()[group.axes.u], lattice.count()[group.axes.v], Kernel::max_rays);
        bool is_first = true;
        for (SweepBatch& batch : sweep_batches(directions_, group, Kernel::max_rays, planes.field())) {
            sweep(group.axes, FirstBatch(std::move(batch), directions_, incident_), is_first, planes, sums, arriving);
            is_first = false;
        }
    }

private:
    void sweep(const SweepAxes& axes, const FirstBatch& batch, bool is_first, TravellingPlanes& planes, Sums& sums,
               Arriving arriving) const {
        const Lattice& lattice = medium_.lattices.of(axes);
        const float* extinction = medium_.extinction().of(axes);
        Kernel kernel = batch.kernel(is_first);
        planes.start(batch.count(), 1);
        for_each_row(lattice, axes, medium_.opaque, nullptr, arriving.data(), progress_, planes,
                     [&](const kernel::SweepPlane& plane, const SweptRow& row) {
                         kernel.plane = plane;
                         kernel::FirstSweepRow to{
                             planes.place(row.v), lattice.count()[axes.u], extinction + row.at, {}, row.opaque};
                         ask_for(row.opaque, batch.octants), ask_for(extinction + row.next, to.count);
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
            const std::vector<Sums>& parts, UncollidedLight& light) {
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

UncollidedLight uncollided_light(const Device& device, const SweptMedium& medium, const FirstDirections& first,
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
    UncollidedLight light{{}, {}, std::vector<OpaqueCells::Faces>(medium.opaque.count())};
    const kernel::FaceKernel meet{arriving.data(),
                                  std::int64_t(faces),
                                  std::int32_t(groups.size()),
                                  nullptr,
                                  OpaqueCells::numbers(light.faces),
                                  nullptr,
                                  0};
    parallel_for(device.threads, std::int64_t(face_count), 4096, [&](std::int64_t face, std::int64_t end) {
        for (; face < end; ++face) meet(face);
    });
    add_up(device, medium.lattices, groups, sums, light);
    if (first.incident.dominant) add_dominant_light(device, medium, *first.incident.dominant, progress, light);
    return light;
}

}  // namespace chiaro
