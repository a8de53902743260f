#include "illumination/transport/first_light.h"

#include <cmath>
#include <numbers>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/sh/directions.h"
#include "illumination/transport/launch.h"
#include "illumination/visibility/sweep.h"

namespace chiaro {
namespace {

using Kernel = kernel::FirstSweepKernel;
using Sums = std::array<LatticeField, Kernel::sums>;
using Arriving = std::vector<float>;  ///< [cell][face][4]

constexpr std::size_t floats_per_cell = 4 * OpaqueCells::faces;

struct Basis {
    float of[8];
};

/// What a ray of T = 1 adds: J, first moment of luminance; twice what its (in + out) is multiplied by.
Basis basis_of(const IncidentRay& ray, Vec3 direction) {
    Basis basis{};
    double y = 0;
    for (int c = 0; c < 3; ++c) {
        basis.of[c] = float(0.5 * ray.light[c]);
        y += luminance_weights[c] * ray.light[c];
    }
    for (int axis = 0; axis < 3; ++axis) basis.of[3 + axis] = float(0.5 * y * direction[axis]);
    basis.of[7] = float(0.5 * ray.share);
    return basis;
}

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

    void operator()(const SweepGroup& group, Sums& sums, Arriving& arriving) const {
        const Lattice& lattice = medium_.lattices.of(group.axes);
        for (auto& field : sums) field = lattice.field();
        arriving.assign(medium_.opaque.listed() * floats_per_cell, 0);
        for (std::size_t first = 0; first < group.directions.size(); first += Kernel::most_rays)
            batch(group.axes, lattice,
                  std::span(group.directions)
                      .subspan(first, std::min<std::size_t>(Kernel::most_rays, group.directions.size() - first)),
                  sums, arriving);
    }

private:
    void batch(const SweepAxes& axes, const Lattice& lattice, std::span<const SweepDirection> chosen, Sums& sums,
               Arriving& arriving) const {
        const int nu = lattice.count()[axes.u], nv = lattice.count()[axes.v], count = int(chosen.size());
        TravellingPlanes planes(nu, nv, count, 1);
        const auto rays = sweep_rays(directions_, chosen, axes, planes.row(), medium_.opaque);
        std::vector<float> edges;
        std::vector<Basis> basis;
        for (const SweepDirection& d : chosen) {
            edges.push_back(float(-std::numbers::log2e * d.length));
            basis.push_back(basis_of(incident_.rays[std::size_t(d.index)], directions_[std::size_t(d.index)]));
        }
        for_each_row(
            lattice, axes, medium_.opaque, nullptr, arriving.data(), progress_, [&](int k, const SweptRow& row) {
                const Kernel kernel{rays.data(), edges.data(), basis[0].of, count, planes.view(k)};
                kernel::FirstSweepRow to{planes.place(row.v), nu, medium_.extinction.of(axes) + row.at, {}, row.opaque};
                for (int s = 0; s < Kernel::sums; ++s) to.sums[s] = sums[s].data() + row.at;
                run_(kernel, to);
            });
    }

    void (*run_)(const Kernel&, const kernel::FirstSweepRow&);
    const SweptMedium& medium_;
    const std::vector<Vec3>& directions_;
    const IncidentLight& incident_;
    Progress& progress_;
};

/// Adds the groups' sums in a fixed order, so that it does not matter who found them.
Sums add_up(const Device& device, const Lattices& lattices, const std::vector<SweepGroup>& groups,
            std::vector<Sums>& parts) {
    Sums all;
    const auto [nx, ny, nz] = lattices.along_x.count();
    for (auto& field : all) field = lattices.along_x.field();
    const std::size_t slice = std::size_t(lattices.along_x.row()) * ny;
    parallel_for(device.threads, nz, 1, [&](std::int64_t z, std::int64_t) {
        std::vector<float> turned(slice);
        for (int s = 0; s < Kernel::sums; ++s) {
            float* to = all[s].data() + std::size_t(z) * slice;
            for (std::size_t g = 0; g < groups.size(); ++g) {
                const bool across = groups[g].axes.major == 0;
                if (across)
                    copy_slice(lattices.along_y, parts[g][s].data(), lattices.along_x, turned.data() - z * slice,
                               int(z));
                const float* from = across ? turned.data() : parts[g][s].data() + std::size_t(z) * slice;
                for (std::size_t i = 0; i < slice; ++i) to[i] += from[i];
            }
        }
    });
    return all;
}

/// Mean radiance of what arrived on the faces.
std::vector<OpaqueCells::Faces> mean_on_faces(std::size_t cells, const std::vector<Arriving>& parts) {
    std::vector<OpaqueCells::Faces> faces(cells);
    for (std::size_t cell = 0; cell < cells; ++cell)
        for (int face = 0; face < OpaqueCells::faces; ++face) {
            std::array<float, 4> sum{};
            for (const Arriving& part : parts)
                for (int c = 0; c < 4; ++c) sum[c] += part[cell * floats_per_cell + 4 * face + c];
            for (int c = 0; c < 3; ++c) faces[cell][face][c] = sum[3] > 0 ? sum[c] / sum[3] : 0;
        }
    return faces;
}

/// A moment per channel from that of luminance: colour and direction of what arrives are told apart.
void colour_moments(const Sums& sums, FirstLight& light) {
    for (int c = 0; c < 3; ++c)
        for (int axis = 0; axis < 3; ++axis) light.moment[c][axis] = sums[3 + axis];
    for (std::size_t i = 0; i < sums[0].size(); ++i) {
        float y = 0;
        for (int c = 0; c < 3; ++c) y += float(luminance_weights[c]) * sums[c][i];
        for (int c = 0; c < 3 && y > 0; ++c)
            for (int axis = 0; axis < 3; ++axis) light.moment[c][axis][i] *= sums[c][i] / y;
    }
}

/// Along straight rays: what arrives at a cell's border, and what of it is left behind the cell.
void add_sun(const Device& device, const SweptMedium& medium, const Sun& sun, Progress& progress, FirstLight& light) {
    const Density& density = medium.grid.extinction;
    const ShField field = sweep_visibility(device, density, {sun.direction}, 4, 0.5, SweepLattice::sheared, progress);
    const SweepGroup group = sweep_groups({sun.direction})[0];
    const auto ray = sweep_rays({sun.direction}, group.directions, group.axes, 1, medium.opaque)[0];
    const double all = std::sqrt(4 * std::numbers::pi);  // V_00 in the open
    const auto [nx, ny, nz] = density.grid.count;
    const auto arriving = [&](std::size_t node) { return field.node(node)[0] / all; };
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t node = density.grid.index(x, y, z), at = medium.lattices.along_x.index(x, y, z);
                const double depth = medium.opaque.is_opaque(node) ? 0 : density.data()[node];
                if (medium.opaque.is_buried(node)) continue;
                const double mean = arriving(node) * (1 + std::exp(-depth * group.directions[0].length)) / 2;
                for (int c = 0; c < 3; ++c) {
                    light.light[c][at] += float(sun.light[c] * mean);
                    for (int axis = 0; axis < 3; ++axis)
                        light.moment[c][axis][at] += float(sun.light[c] * mean * sun.direction[axis]);
                }
            }
    for (std::size_t cell = 0; cell < medium.opaque.count(); ++cell) {
        const std::size_t node = medium.opaque.nodes()[cell];
        const int x = int(node % nx), y = int(node / nx % ny), z = int(node / nx / ny);
        const float share = kernel::open_share(ray, medium.opaque.clear_cells() + medium.opaque.bit_index(x, y, z));
        if (share < kernel::least_open) continue;
        for (int axis = 0; axis < 3; ++axis)
            for (int c = 0; c < 3; ++c)  // irradiance / π, light being ∫ L dω / 4π
                light.faces[cell][2 * axis + (sun.direction[axis] < 0)][c] +=
                    float(4 * sun.light[c] * std::abs(sun.direction[axis]) * std::min(arriving(node) / share, 1.0));
    }
}

}  // namespace

SweptMedium::SweptMedium(const LightGrid& light_grid, const OpaqueCells& cells)
    : grid(light_grid), opaque(cells), lattices(light_grid.extinction.grid.count) {
    const CellGrid& nodes = grid.extinction.grid;
    std::vector<float> swept(grid.extinction.data(), grid.extinction.data() + nodes.size());
    for (std::size_t node = 0; node < swept.size(); ++node)
        if (opaque.is_opaque(node)) swept[node] = opaque.is_listed(node) ? 0 : 1e4f;
    extinction = {spread(nodes, swept.data(), lattices.along_x), spread(nodes, swept.data(), lattices.along_y)};
}

FirstLight first_light(const Device& device, const SweptMedium& medium, const Lighting& lighting, Vec3 orbit_up,
                       const Geometry& geometry, int first_directions, Progress& progress) {
    const std::vector<Vec3> directions = fibonacci_directions(first_directions);
    const IncidentLight incident = incident_light(lighting, orbit_up, geometry, directions);
    const std::vector<SweepGroup> groups = sweep_groups(directions);
    std::vector<Sums> sums(groups.size());
    std::vector<Arriving> arriving(groups.size());
    const GroupSweep sweep(device, medium, directions, incident, progress);
    parallel_for(device.threads, std::int64_t(groups.size()), 1, "light", progress,
                 [&](std::int64_t g, std::int64_t) { sweep(groups[g], sums[g], arriving[g]); });
    progress.check();
    const Sums all = add_up(device, medium.lattices, groups, sums);
    FirstLight light{{all[0], all[1], all[2]}, {}, mean_on_faces(medium.opaque.count(), arriving)};
    colour_moments(all, light);
    if (incident.sun) add_sun(device, medium, *incident.sun, progress, light);
    return light;
}

}  // namespace chiaro
