#include "illumination/transport/solver.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/threads.h"
#include "illumination/transport/directions.h"
#include "illumination/transport/first_light.h"
#include "illumination/transport/launch.h"

namespace chiaro {
namespace {

using Colour = std::array<LatticeField, 3>;
using Faces = OpaqueCells::Faces;

constexpr double relaxation = 1.5;
constexpr int most_iterations = 64;  ///< of a solution that converges
constexpr double converged = 1e-3;   ///< where no error was asked for

/// The last of n sweeps counts so much in the running mean: early ones, far from the solution, are soon forgotten.
double share_of_sweep(int n) { return 4.0 / (n + 3); }

/// Cell edges from plane to plane; the inverse of the mean cosine to the major axis.
double mean_step(const std::vector<Vec3>& directions) {
    double cosines = 0;
    for (Vec3 d : directions) cosines += std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return double(directions.size()) / cosines;
}

/// [ray][pattern][tap]: bilinear between the cells that a pattern calls clear; 0 where a ray does not count.
std::vector<float> weights_of_patterns(const SweepBatch& batch) {
    std::vector<float> weights;
    for (std::size_t r = 0; r < batch.rays.size(); ++r)
        for (int pattern = 0; pattern < kernel::OctantRays::patterns; ++pattern) {
            const float share = batch.open_share(int(r), pattern);
            for (int tap = 0; tap < 4; ++tap)
                weights.push_back(
                    share >= kernel::least_open && (pattern >> tap & 1) ? batch.rays[r].weight[tap] / share : 0);
        }
    return weights;
}

Colour colour(const Lattice& lattice) { return {lattice.field(), lattice.field(), lattice.field()}; }

}  // namespace

struct TransportSolver::State {
    Device device;
    TransportSettings settings;
    ScatteringSettings scattering;
    LightGrid grid;
    OpaqueCells opaque;
    SweptMedium medium;
    FirstLight first;
    Colour albedo, source, mean;           ///< rows along x
    Colour source_across;                  ///< the same source, rows along y
    std::array<Colour, 6> sums;            ///< by the side that light comes from; those of x: rows along y
    std::array<Colour, 3> moment;          ///< [channel][axis], running mean
    std::vector<Faces> faces, mean_faces;  ///< all the light on the opaque cells' faces; its running mean
    LatticeField emission;
    std::vector<float> weight;  ///< of each node (nodes.h)
    int iterations = 0;
    double change = std::numeric_limits<double>::infinity();

    State(const Device& d, const Medium::Data& medium_data, const Lighting& lighting, const TransportSettings& s,
          const ScatteringSettings& sc, Vec3 orbit_up, Progress& progress);

    bool is_accelerated() const { return !scattering.bounces.most; }
    bool is_done() const;
    void sweep(const std::vector<Vec3>& directions, const SweepGroup& group, const Progress& progress,
               LatticeField& arriving);
    void sweep(const std::vector<Vec3>& directions, Progress& progress, std::vector<LatticeField>& arriving);
    double update(double length);
    void update_faces(const std::vector<LatticeField>& arriving);
    void start_from(const TransportNodes& warm);
    void turn_source();
};

namespace {

/// Henyey and Greenstein's g by similarity: what goes on as if nothing had been, κ a g, is left out of the extinction.
/// Exact for the first moment; grey, with the mean albedo.
LightGrid similar(LightGrid grid, double g) {
    if (g == 0) return grid;
    float* extinction = grid.extinction.data();
    for (std::size_t i = 0; i < grid.extinction.grid.size(); ++i) {
        const double mean = (double(grid.albedo[0][i]) + grid.albedo[1][i] + grid.albedo[2][i]) / 3,
                     kept = 1 - mean * g;
        extinction[i] = float(extinction[i] * kept);
        for (auto& channel : grid.albedo) channel[i] = float(std::max(1 - (1 - channel[i]) / kept, 0.0));
    }
    return grid;
}

LatticeField albedo_of(const LightGrid& grid, const OpaqueCells& opaque, int channel, const Lattice& lattice) {
    std::vector<float> albedo = grid.albedo[channel];
    for (std::size_t node = 0; node < albedo.size(); ++node)
        if (opaque.is_opaque(node)) albedo[node] = 0;
    return spread(grid.extinction.grid, albedo.data(), lattice);
}

}  // namespace

TransportSolver::State::State(const Device& d, const Medium::Data& medium_data, const Lighting& lighting,
                              const TransportSettings& s, const ScatteringSettings& sc, Vec3 orbit_up,
                              Progress& progress)
    : device(d),
      settings(s),
      scattering(sc),
      grid(similar(light_grid(medium_data, s.grid, sc.albedo_max, d, progress), sc.anisotropy)),
      opaque(grid, is_accelerated() ? opaque_from : std::numeric_limits<float>::infinity()),
      medium(grid, opaque),
      first(
          first_light(d, medium, lighting, orbit_up, medium_data.volume.data().geometry, s.first_directions, progress)),
      source(colour(medium.lattices.along_x)),
      mean(first.light),
      source_across(colour(medium.lattices.along_y)),
      faces(first.faces),
      mean_faces(first.faces),
      weight(grid.extinction.grid.size()) {
    for (int c = 0; c < 3; ++c) {
        albedo[c] = albedo_of(grid, opaque, c, medium.lattices.along_x);
        moment[c] = colour(medium.lattices.along_x);
        for (std::size_t i = 0; i < source[c].size(); ++i) source[c][i] = albedo[c][i] * first.light[c][i];
    }
    for (std::size_t node = 0; node < weight.size(); ++node)
        weight[node] = std::max(float(-std::expm1(-grid.extinction.data()[node])), 1e-3f);
    for (int side = 0; side < 6; ++side)
        sums[side] = colour(side < 2 ? medium.lattices.along_y : medium.lattices.along_x);
    opaque.reflect(faces, emission);
    turn_source();
}

bool TransportSolver::State::is_done() const {
    if (scattering.bounces.most) return iterations >= *scattering.bounces.most;
    return iterations >= most_iterations || change < settings.error.value_or(converged);
}

/// One group of directions after the other plane by plane; groups side by side.
void TransportSolver::State::sweep(const std::vector<Vec3>& directions, Progress& progress,
                                   std::vector<LatticeField>& arriving) {
    const std::vector<SweepGroup> groups = sweep_groups(directions);
    arriving.assign(groups.size(), {});
    if (groups.size() < sums.size())  // few directions: no light came from some sides
        for (Colour& of_side : sums)
            for (LatticeField& field : of_side) std::fill(field.begin(), field.end(), 0.0f);
    parallel_for(device.threads, std::int64_t(groups.size()), 1, "scattering", progress,
                 [&](std::int64_t g, std::int64_t) { sweep(directions, groups[g], progress, arriving[g]); });
    progress.check();
}

void TransportSolver::State::sweep(const std::vector<Vec3>& directions, const SweepGroup& group,
                                   const Progress& progress, LatticeField& arriving) {
    using Kernel = kernel::SourceSweepKernel;
    const auto run = kernel::transport_functions_for(device.isa).source_row;
    const SweepAxes& axes = group.axes;
    const Lattice& lattice = medium.lattices.of(axes);
    const Colour& from = lattice.along_y() ? source_across : source;
    Colour& to = sums[side_of(axes)];
    arriving.assign(opaque.count() * 4 * OpaqueCells::faces, 0);
    const int nu = lattice.count()[axes.u], nv = lattice.count()[axes.v];
    TravellingPlanes planes(nu, nv, Kernel::channels * Kernel::most_rays);
    bool is_first = true;
    for (SweepBatch& batch :
         sweep_batches(directions, group, Kernel::most_rays, Kernel::channels * planes.field(), opaque)) {
        batch.weigh(std::vector<float>(batch.rays.size(), 1));
        const std::vector<float> open_weights = weights_of_patterns(batch);
        planes.start(Kernel::channels * int(batch.rays.size()), 0);
        Kernel kernel{batch.rays.data(),
                      float(0.5 / double(directions.size())),
                      batch.octants.data(),
                      std::int32_t(batch.octants.size()),
                      open_weights.data(),
                      batch.cosines[0].data(),
                      std::int32_t(batch.rays.size()),
                      is_first,
                      {}};
        const auto visit = [&](const kernel::SweepPlane& plane, const SweptRow& row) {
            kernel.plane = plane;
            kernel::SourceRow at{planes.place(row.v), nu, medium.extinction.of(axes) + row.at, {}, {}, row.opaque};
            ask_for(row.opaque, batch.octants), ask_for(medium.extinction.of(axes) + row.next, nu);
            for (int c = 0; c < 3; ++c) {
                at.source[c] = from[c].data() + row.at, at.sums[c] = to[c].data() + row.at;
                ask_for(from[c].data() + row.next, nu), ask_for(to[c].data() + row.next, nu);
            }
            run(kernel, at);
        };
        for_each_row(lattice, axes, opaque, emission.data(), arriving.data(), progress, planes, visit);
        is_first = false;
    }
}

/// J, its mean and the next source; returns the relative change of the mean.
double TransportSolver::State::update(double length) {
    const Lattice &along_x = medium.lattices.along_x, &along_y = medium.lattices.along_y;
    const auto [nx, ny, nz] = along_x.count();
    const auto run = kernel::transport_functions_for(device.isa).update_row;
    const std::size_t slice = std::size_t(along_x.row()) * ny;
    const kernel::UpdateKernel kernel{float(-std::numbers::log2e * length),
                                      is_accelerated() ? float(iterations == 0 ? 1 : relaxation) : 0.0f,
                                      is_accelerated() ? float(share_of_sweep(iterations + 1)) : 1.0f, float(length)};
    std::vector<std::array<double, 2>> changes(std::size_t(nz), {0, 0});
    parallel_for(device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        LatticeField turned(6 * slice);
        const std::size_t start = std::size_t(z) * slice;
        for (int i = 0; i < 6; ++i)
            copy_slice(along_y, sums[i / 3][i % 3].data(), along_x, turned.data() + i * slice - start, int(z));
        float lanes[2][16]{};
        for (int y = 0; y < ny; ++y) {
            const std::size_t in_slice = std::size_t(y) * along_x.row(), at = start + in_slice;
            kernel::UpdateRow row{};
            row.count = nx, row.extinction = medium.extinction.along_x.data() + at, row.change = &lanes;
            for (int c = 0; c < 3; ++c) {
                row.albedo[c] = albedo[c].data() + at, row.first[c] = first.light[c].data() + at;
                row.source[c] = source[c].data() + at, row.mean[c] = mean[c].data() + at;
                for (int axis = 0; axis < 3; ++axis) row.moment[c][axis] = moment[c][axis].data() + at;
                for (int side = 0; side < 6; ++side)
                    row.sums[side][c] =
                        side < 2 ? turned.data() + (3 * side + c) * slice + in_slice : sums[side][c].data() + at;
            }
            run(kernel, row);
        }
        for (int i = 0; i < 2; ++i)
            for (float lane : lanes[i]) changes[std::size_t(z)][std::size_t(i)] += lane;
        for (int c = 0; c < 3; ++c) copy_slice(along_x, source[c].data(), along_y, source_across[c].data(), int(z));
    });
    double step = 0, size = 0;
    for (const auto& of_slice : changes) step += of_slice[0], size += of_slice[1];
    return size > 0 ? std::sqrt(step / size) : 0;
}

void TransportSolver::State::update_faces(const std::vector<LatticeField>& arriving) {
    const float share = float(share_of_sweep(iterations + 1));
    for (std::size_t cell = 0; cell < opaque.count(); ++cell)
        for (int face = 0; face < OpaqueCells::faces; ++face) {
            std::array<float, 4> sum{};
            for (const auto& part : arriving)
                for (int c = 0; c < 4; ++c) sum[c] += part[(cell * OpaqueCells::faces + face) * 4 + c];
            for (int c = 0; c < 3; ++c) {
                const float light = first.faces[cell][face][c] + (sum[3] > 0 ? sum[c] / sum[3] : 0);
                float& running = mean_faces[cell][face][c];
                faces[cell][face][c] = light;
                running += share * (light - running);
            }
        }
    opaque.reflect(faces, emission);
}

void TransportSolver::State::turn_source() {
    parallel_for(device.threads, medium.lattices.along_x.count()[2], 1, [&](std::int64_t z, std::int64_t) {
        for (int c = 0; c < 3; ++c)
            copy_slice(medium.lattices.along_x, source[c].data(), medium.lattices.along_y, source_across[c].data(),
                       int(z));
    });
}

/// Of a similar medium, perhaps on another grid: the nearest nodes' light.
void TransportSolver::State::start_from(const TransportNodes& warm) {
    const CellGrid &here = grid.extinction.grid, &there = warm.grid;
    const auto nearest = [&](int axis, int i) {
        const double voxel = (i + 0.5) * here.voxels_per_cell[axis];
        return std::clamp(int(voxel / there.voxels_per_cell[axis]), 0, there.count[axis] - 1);
    };
    const auto light_at = [&](int x, int y, int z) {
        return warm.light.data() + 3 * there.index(nearest(0, x), nearest(1, y), nearest(2, z));
    };
    for (int z = 0; z < here.count[2]; ++z)
        for (int y = 0; y < here.count[1]; ++y)
            for (int x = 0; x < here.count[0]; ++x)
                for (int c = 0; c < 3; ++c) {
                    const std::size_t at = medium.lattices.along_x.index(x, y, z);
                    source[c][at] = albedo[c][at] * light_at(x, y, z)[c];
                }
    for (std::size_t cell = 0; cell < opaque.count(); ++cell) {
        const std::size_t node = opaque.nodes()[cell];
        const int nx = here.count[0], ny = here.count[1];
        const float* light = light_at(int(node % nx), int(node / nx % ny), int(node / nx / ny));
        for (auto& face : faces[cell])
            for (int c = 0; c < 3; ++c) face[c] = std::max(face[c], light[c]);
    }
    opaque.reflect(faces, emission);
    turn_source();
}

namespace {

/// Samples look between nodes: a cell behind the faces of others holds what those hold, on average.
void fill_behind(const OpaqueCells& opaque, TransportNodes& nodes) {
    const auto [nx, ny, nz] = nodes.grid.count;
    const auto fill = [&, nx = nx, ny = ny, nz = nz](int x, int y, int z) {
        std::array<float, 12> sum{};
        float count = 0;
        for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i) {
                    const std::size_t node = nodes.grid.index(i, j, k);
                    if (!opaque.is_opaque(node) || opaque.is_buried(node)) continue;
                    for (int c = 0; c < 3; ++c) sum[c] += nodes.light[3 * node + c];
                    for (int m = 0; m < 9; ++m) sum[3 + m] += nodes.moment[9 * node + m];
                    count += 1;
                }
        const std::size_t node = nodes.grid.index(x, y, z);
        for (int c = 0; c < 3; ++c) nodes.light[3 * node + c] = count > 0 ? sum[c] / count : 0;
        for (int m = 0; m < 9; ++m) nodes.moment[9 * node + m] = count > 0 ? sum[3 + m] / count : 0;
    };
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                if (opaque.is_buried(nodes.grid.index(x, y, z))) fill(x, y, z);
}

}  // namespace

TransportSolver::TransportSolver(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                                 const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                                 Progress& progress, const TransportSolver* warm)
    : state_(std::make_unique<State>(device, medium, lighting, settings, scattering, orbit_up, progress)) {
    if (warm && state_->is_accelerated() && warm->iterations() > 0) state_->start_from(warm->nodes());
}
TransportSolver::TransportSolver(TransportSolver&&) noexcept = default;
TransportSolver& TransportSolver::operator=(TransportSolver&&) noexcept = default;
TransportSolver::~TransportSolver() = default;

int TransportSolver::iterations() const { return state_->iterations; }
double TransportSolver::change() const { return state_->change; }

bool TransportSolver::iterate(Progress& progress) {
    State& s = *state_;
    if (s.is_done()) return false;
    const std::vector<Vec3> directions = turned_directions(s.settings.directions, s.iterations, s.scattering.seed);
    std::vector<LatticeField> arriving;
    s.sweep(directions, progress, arriving);
    const double change = s.update(mean_step(directions));
    s.change = s.iterations == 0 ? std::numeric_limits<double>::infinity() : change;
    if (s.is_accelerated()) s.update_faces(arriving);
    ++s.iterations;
    return true;
}

TransportNodes TransportSolver::nodes() const {
    const State& s = *state_;
    const CellGrid& grid = s.grid.extinction.grid;
    TransportNodes out{grid, {}, s.weight, {}, {}, s.iterations, s.change};
    out.light.resize(3 * grid.size()), out.moment.resize(9 * grid.size());
    const auto [nx, ny, nz] = grid.count;
    parallel_for(s.device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t node = grid.index(x, y, int(z)), at = s.medium.lattices.along_x.index(x, y, int(z));
                for (int c = 0; c < 3; ++c) {
                    out.light[3 * node + c] = s.mean[c][at];
                    for (int axis = 0; axis < 3; ++axis)
                        out.moment[9 * node + 3 * c + axis] = s.moment[c][axis][at] + s.first.moment[c][axis][at];
                }
            }
    });
    if (s.opaque.count() > 0) out.answer.resize(3 * grid.size());
    for (std::size_t cell = 0; cell < s.opaque.count(); ++cell) {
        const auto at = std::ptrdiff_t(3 * s.opaque.nodes()[cell]);
        const auto seen = s.opaque.seen(cell, s.mean_faces[cell]);
        std::copy(seen.begin(), seen.end(), out.light.begin() + at);
        std::copy_n(s.opaque.per_albedo(cell).begin(), 3, out.answer.begin() + at);
    }
    if (!out.answer.empty())
        for (const std::size_t node : s.grid.skins)
            for (int c = 0; c < 3; ++c) out.answer[3 * node + c] = float(reflected_per_albedo(s.grid.albedo[c][node]));
    fill_behind(s.opaque, out);
    return out;
}

}  // namespace chiaro
