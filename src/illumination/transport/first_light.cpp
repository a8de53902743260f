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
using Arriving = LatticeField;  ///< [cell][face][4]

/// Deeper cells let no more through than this one does, 2e-9; what the kernels raise two to stays above -126.
constexpr float most_depth = 20;

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
    return basis;
}

/// A batch and what its kernel reads beside the rays.
struct FirstBatch : SweepBatch {
    std::vector<Basis> basis;
    std::vector<float> per_share, on_faces;

    FirstBatch(SweepBatch batch, const std::vector<Vec3>& all, const IncidentLight& incident)
        : SweepBatch(std::move(batch)), per_share(std::size_t(kernel::OctantRays::patterns) * Kernel::most_rays) {
        std::vector<float> weights;
        for (std::size_t r = 0; r < rays.size(); ++r) {
            const auto direction = std::size_t(directions[r]);
            basis.push_back(basis_of(incident.rays[direction], all[direction]));
            weights.push_back(float(0.5 * incident.rays[direction].share));
            for (int axis = 0; axis < 3; ++axis) {
                for (int c = 0; c < 3; ++c) on_faces.push_back(cosines[r][axis] * basis[r].of[c]);
                on_faces.push_back(0);
            }
            on_faces.resize(on_faces.size() + 4);
            for (int pattern = 0; pattern < kernel::OctantRays::patterns; ++pattern)
                if (const float share = open_share(int(r), pattern); share >= kernel::least_open)
                    per_share[std::size_t(pattern) * Kernel::most_rays + r] = 1 / share;
        }
        weigh(weights);
    }
};

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
        for (auto& field : sums) field = lattice.unset_field();
        arriving.assign(medium_.opaque.count() * floats_per_cell, 0);
        TravellingPlanes planes(lattice.count()[group.axes.u], lattice.count()[group.axes.v], Kernel::most_rays);
        bool is_first = true;
        for (SweepBatch& batch : sweep_batches(directions_, group, Kernel::most_rays, planes.field(), medium_.opaque)) {
            sweep(group.axes, FirstBatch(std::move(batch), directions_, incident_), is_first, planes, sums, arriving);
            is_first = false;
        }
    }

private:
    void sweep(const SweepAxes& axes, const FirstBatch& batch, bool is_first, TravellingPlanes& planes, Sums& sums,
               Arriving& arriving) const {
        const Lattice& lattice = medium_.lattices.of(axes);
        const int count = int(batch.rays.size());
        planes.start(count, 1);
        for_each_row(
            lattice, axes, medium_.opaque, nullptr, arriving.data(), progress_, planes,
            [&](const kernel::SweepPlane& plane, const SweptRow& row) {
                const Kernel kernel{batch.rays.data(),
                                    batch.basis[0].of,
                                    batch.octants.data(),
                                    std::int32_t(batch.octants.size()),
                                    batch.per_share.data(),
                                    batch.on_faces.data(),
                                    count,
                                    is_first,
                                    plane};
                kernel::FirstSweepRow to{
                    planes.place(row.v), lattice.count()[axes.u], medium_.extinction.of(axes) + row.at, {}, row.opaque};
                ask_for(row.opaque, batch.octants), ask_for(medium_.extinction.of(axes) + row.next, to.count);
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
            per_luminance[i] =
                1 / std::max(1e-30f, float(luminance_weights[0]) * j[0][i] + float(luminance_weights[1]) * j[1][i] +
                                         float(luminance_weights[2]) * j[2][i]);
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis) {
                float* to = light.moment[c][axis].data() + std::size_t(z) * slice;
                const float *of = moment[axis].data(), *own = j[c];
                for (std::size_t i = 0; i < slice; ++i) to[i] = of[i] * (own[i] * per_luminance[i]);
            }
    });
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

/// Along straight rays: what arrives at a cell's border, and what of it is left behind the cell.
void add_sun(const Device& device, const SweptMedium& medium, const Sun& sun, Progress& progress, FirstLight& light) {
    const Density& density = medium.grid.extinction;
    const ShField field = sweep_visibility(device, density, {sun.direction}, 4, 0.5, SweepLattice::sheared, progress);
    const SweepGroup group = sweep_groups({sun.direction})[0];
    const SweepBatch ray = sweep_batches({sun.direction}, group, 1, 1, medium.opaque)[0];
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
        const kernel::OpaqueRow at{.clear = medium.opaque.clear_cells() + medium.opaque.bit_index(x, y, z)};
        const float share = ray.open_share(0, at.pattern(ray.octants[0], {}));
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
        if (opaque.is_opaque(node))
            swept[node] = opaque.is_listed(node) ? 0 : most_depth;
        else
            swept[node] = std::min(swept[node], most_depth);
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
    FirstLight light{{}, {}, mean_on_faces(medium.opaque.count(), arriving)};
    add_up(device, medium.lattices, groups, sums, light);
    if (incident.sun) add_sun(device, medium, *incident.sun, progress, light);
    return light;
}

}  // namespace chiaro
