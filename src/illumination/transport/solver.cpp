#include "illumination/transport/solver.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/transport/batches.h"
#include "illumination/transport/directions.h"
#include "illumination/transport/launch.h"
#include "illumination/transport/solver_state.h"

namespace chiaro {
namespace {

// The factor of S += relaxation (a J - S) / (1 - a C) in docs/theory/transport.md: over-relaxation, as 1 would take
// each sweep as it is. 1.5, the limit of 64 iterations and 1e-3 are here unchanged since the solver's first version;
// how they were chosen is not recorded.
constexpr double relaxation = 1.5;
constexpr int max_iterations = 64;  ///< where bounces are unlimited: a bound on the time, should it not converge
constexpr double converged = 1e-3;  ///< relative change of J that ends the iteration, where no error was asked for

/// Weight of the n-th sweep in the running mean. A plain mean has 1 / n. With 4 / (n + 3), which is 1 for n = 1, the
/// weight of an early sweep, far from the solution, falls as n^-4, and the noise of n sweeps as 4 / √(7 n) for large n.
double share_of_sweep(int n) { return 4.0 / (n + 3); }

/// Cell edges from plane to plane; the inverse of the mean cosine to the major axis.
double mean_step(const std::vector<Vec3>& directions) {
    double cosines = 0;
    for (Vec3 d : directions) cosines += std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return double(directions.size()) / cosines;
}

/// Of the mean, from [z][2][16]: by slice and lane, Σ (change of it)² and Σ of its squares.
double relative_change(const std::vector<float>& lanes) {
    double sums[2]{};
    for (std::size_t first = 0; first < lanes.size(); first += 16) {
        double of_slice = 0;
        for (std::size_t lane = 0; lane < 16; ++lane) of_slice += lanes[first + lane];
        sums[first / 16 % 2] += of_slice;
    }
    return sums[1] > 0 ? std::sqrt(sums[0] / sums[1]) : 0;
}

/// Of another grid, the nearest to the cells of this one: what each coordinate adds to its index.
struct NearestNodes {
    std::array<int, 3> count;
    std::array<std::vector<std::int32_t>, 3> along;

    NearestNodes(const CellGrid& here, const CellGrid& there) : count(here.count) {
        int stride = 1;
        for (int axis = 0; axis < 3; stride *= there.count[axis++])
            for (int i = 0; i < count[axis]; ++i) {
                const double voxel = (i + 0.5) * here.voxels_per_cell[axis];
                const int node = int(voxel / there.voxels_per_cell[axis]);
                along[axis].push_back(stride * std::clamp(node, 0, there.count[axis] - 1));
            }
    }
    std::int64_t of(std::size_t cell) const {
        const std::size_t nx = std::size_t(count[0]), ny = std::size_t(count[1]);
        return along[0][cell % nx] + along[1][cell / nx % ny] + along[2][cell / nx / ny];
    }
};

}  // namespace

TransportSolver::State::State(const Device& d, SharedTransportMedium m, const Lighting& lighting,
                              const TransportSettings& s, const ScatteringSettings& sc, Vec3 orbit_up,
                              Progress& progress)
    : device(d), matter(std::move(m)), settings(s), scattering(sc) {
    const FirstDirections directions(lighting, orbit_up, matter->geometry, s.first_directions);
    const auto on_gpu = [&] {
        auto started = std::make_unique<GpuTransport>(device, medium);
        started->start(device, directions, progress);
        gpu = std::move(started);
    };
    if (!cuda::try_gpu(device, on_gpu)) start(directions, progress);
}

void TransportSolver::State::start(const FirstDirections& directions, Progress& progress) {
    first = uncollided_light(device, medium, directions, progress);
    mean = first.light, faces = mean_faces = first.faces;
    source = colour(medium.lattices.along_x);
    const Colour& albedo = matter->albedo();
    for (int c = 0; c < 3; ++c) {
        moment[c] = colour(medium.lattices.along_x);
        for (std::size_t i = 0; i < source[c].size(); ++i) source[c][i] = albedo[c][i] * first.light[c][i];
    }
    prepare();
}

/// What sweeps need beside the light.
void TransportSolver::State::prepare() {
    source_across = colour(medium.lattices.along_y);
    for (int side = 0; side < 6; ++side)
        for (LatticeField& field : sums[side])
            field = (side < 2 ? medium.lattices.along_y : medium.lattices.along_x).field();
    opaque.reflect(faces, device.threads, emission);
    turn_source();
}

/// The GPU has no room any more.
void TransportSolver::State::fall_back_to_host() {
    gpu->fetch(*this);
    gpu.reset();
    prepare();
}

bool TransportSolver::State::is_done() const {
    if (scattering.bounces.most) return iterations >= *scattering.bounces.most;
    return iterations >= max_iterations || change < settings.error.value_or(converged);
}

/// One sweep of scattered light and what follows; returns the relative change of the mean.
double TransportSolver::State::iterate(const std::vector<Vec3>& directions, Progress& progress) {
    const double length = mean_step(directions);
    const kernel::UpdateKernel kernel{
        float(-std::numbers::log2e * length),
        is_accelerated() ? float(iterations == 0 ? 1 : relaxation) : 0.0f,
        is_accelerated() ? float(share_of_sweep(iterations + 1)) : 1.0f,
        float(1 / length),
        {float(luminance_weights[0]), float(luminance_weights[1]), float(luminance_weights[2])}};
    std::vector<float> changes;
    const auto on_gpu = [&] { changes = gpu->iterate(directions, kernel, progress); };
    if (gpu && cuda::try_gpu(device, on_gpu)) return relative_change(changes);
    if (gpu) fall_back_to_host();
    const LatticeField arriving = sweep(directions, progress);
    const double found = update(kernel);
    update_faces(arriving, kernel.share);
    return found;
}

/// One group of directions after the other plane by plane; groups side by side. Returns what arrived on faces:
/// [group][cell][face][4].
LatticeField TransportSolver::State::sweep(const std::vector<Vec3>& directions, Progress& progress) {
    const std::vector<SweepGroup> groups = sweep_groups(directions);
    const std::size_t of_group = opaque.count() * kernel::cell_floats;
    LatticeField arriving(groups.size() * of_group);
    if (groups.size() < sums.size())  // few directions: no light came from some sides
        for (Sums& of_side : sums)
            for (LatticeField& field : of_side) std::fill(field.begin(), field.end(), 0.0f);
    parallel_for(
        device.threads, std::int64_t(groups.size()), 1, "scattering", progress, [&](std::int64_t g, std::int64_t) {
            sweep(directions, groups[g], progress, std::span(arriving).subspan(std::size_t(g) * of_group, of_group));
        });
    progress.check();
    return arriving;
}

void TransportSolver::State::sweep(const std::vector<Vec3>& directions, const SweepGroup& group,
                                   const Progress& progress, std::span<float> arriving) {
    using Kernel = kernel::SourceSweepKernel;
    const auto run = kernel::transport_functions_for(device.isa).source_row;
    const SweepAxes& axes = group.axes;
    const Lattice& lattice = medium.lattices.of(axes);
    const float* extinction = medium.extinction().of(axes);
    const Colour& from = lattice.along_y() ? source_across : source;
    Sums& to = sums[side_of(axes)];
    std::fill(arriving.begin(), arriving.end(), 0.0f);
    const int nu = lattice.count()[axes.u], nv = lattice.count()[axes.v];
    TravellingPlanes planes(nu, nv, Kernel::channels * Kernel::max_rays);
    bool is_first = true;
    for (SweepBatch& rays : sweep_batches(directions, group, Kernel::max_rays, Kernel::channels * planes.field())) {
        const SourceBatch batch(std::move(rays), directions, axes);
        planes.start(Kernel::channels * batch.count(), 0);
        Kernel kernel = batch.kernel(directions.size(), is_first);
        const auto visit = [&](const kernel::SweepPlane& plane, const SweptRow& row) {
            kernel.plane = plane;
            kernel::SourceRow at{planes.place(row.v), nu, extinction + row.at, {}, {}, row.opaque};
            ask_for(row.opaque, batch.octants), ask_for(extinction + row.next, nu);
            for (int c = 0; c < 3; ++c) {
                at.source[c] = from[c].data() + row.at;
                ask_for(from[c].data() + row.next, nu);
            }
            for (int s = 0; s < Kernel::sums; ++s) {
                at.sums[s] = to[s].data() + row.at;
                ask_for(to[s].data() + row.next, nu);
            }
            run(kernel, at);
        };
        for_each_row(lattice, axes, opaque, emission.data(), arriving.data(), progress, planes, visit);
        is_first = false;
    }
}

/// J, its mean and the next source; returns the relative change of the mean.
double TransportSolver::State::update(const kernel::UpdateKernel& kernel) {
    const Lattice &along_x = medium.lattices.along_x, &along_y = medium.lattices.along_y;
    const auto [nx, ny, nz] = along_x.count();
    const Colour& albedo = matter->albedo();
    const float* extinction = medium.extinction().along_x.data();
    const auto run = kernel::transport_functions_for(device.isa).update_row;
    const std::size_t slice = std::size_t(along_x.row()) * ny;
    std::vector<float> changes(std::size_t(nz) * 2 * 16, 0);
    parallel_for(device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        constexpr int per_side = kernel::SourceSweepKernel::sums;
        LatticeField turned(2 * per_side * slice);
        const std::size_t start = std::size_t(z) * slice;
        for (int i = 0; i < 2 * per_side; ++i)
            copy_slice(along_y, sums[i / per_side][i % per_side].data(), along_x, turned.data() + i * slice - start,
                       int(z));
        float lanes[2][16]{};
        for (int y = 0; y < ny; ++y) {
            const std::size_t in_slice = std::size_t(y) * along_x.row(), at = start + in_slice;
            kernel::UpdateRow row{};
            row.count = nx, row.extinction = extinction + at, row.change = &lanes;
            for (int c = 0; c < 3; ++c) {
                row.albedo[c] = albedo[c].data() + at, row.first[c] = first.light[c].data() + at;
                row.source[c] = source[c].data() + at, row.mean[c] = mean[c].data() + at;
                for (int axis = 0; axis < 3; ++axis) row.moment[c][axis] = moment[c][axis].data() + at;
            }
            for (int side = 0; side < 6; ++side)
                for (int s = 0; s < per_side; ++s)
                    row.sums[side][s] =
                        side < 2 ? turned.data() + (per_side * side + s) * slice + in_slice : sums[side][s].data() + at;
            run(kernel, row);
        }
        std::memcpy(changes.data() + z * 2 * 16, lanes, sizeof lanes);
        for (int c = 0; c < 3; ++c) copy_slice(along_x, source[c].data(), along_y, source_across[c].data(), int(z));
    });
    return relative_change(changes);
}

void TransportSolver::State::update_faces(const LatticeField& arriving, float share) {
    const std::size_t of_group = opaque.count() * kernel::cell_floats;
    if (of_group == 0) return;
    const kernel::FaceKernel meet{arriving.data(),
                                  std::int64_t(of_group),
                                  std::int32_t(arriving.size() / of_group),
                                  OpaqueCells::numbers(first.faces),
                                  OpaqueCells::numbers(faces),
                                  OpaqueCells::numbers(mean_faces),
                                  share};
    parallel_for(device.threads, std::int64_t(opaque.count() * OpaqueCells::faces), 4096,
                 [&](std::int64_t face, std::int64_t end) {
                     for (; face < end; ++face) meet(face);
                 });
    opaque.reflect(faces, device.threads, emission);
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
    const NearestNodes nearest(matter->grid.extinction.grid, warm.grid);
    kernel::NearestKernel kernel{
        cell_places(medium.lattices.along_x, medium.lattices.along_y), {}, warm.light.data(), {}, {}};
    HostArrays arrays;
    arrays.add(warm.light);
    for (int axis = 0; axis < 3; ++axis) {
        kernel.nearest[axis] = nearest.along[axis].data();
        arrays.add(nearest.along[axis]);
    }
    const auto shine_on = [&](GpuTransport::Faces lit) {
        for (std::size_t cell = 0; cell < opaque.count(); ++cell) {
            const float* light = warm.light.data() + 3 * nearest.of(opaque.nodes()[cell]);
            for (auto& face : lit[cell])
                for (int c = 0; c < 3; ++c) face[c] = std::max(face[c], light[c]);
        }
        return lit;
    };
    if (gpu && cuda::try_gpu(device, [&] { gpu->start_from(kernel, arrays, shine_on(gpu->faces())); })) return;
    if (gpu) fall_back_to_host();
    faces = shine_on(std::move(faces));
    for (int c = 0; c < 3; ++c) kernel.albedo[c] = matter->albedo()[c].data(), kernel.source[c] = source[c].data();
    for (std::int64_t cell = 0; cell < kernel.places.count(); ++cell) kernel(cell);
    opaque.reflect(faces, device.threads, emission);
    turn_source();
}

TransportSolver::TransportSolver(const Device& device, SharedTransportMedium matter, const Lighting& lighting,
                                 const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                                 Progress& progress, const TransportNodes* warm)
    : state_(std::make_unique<State>(device, std::move(matter), lighting, settings, scattering, orbit_up, progress)) {
    if (warm && state_->is_accelerated() && warm->iterations > 0) state_->start_from(*warm);
}
TransportSolver::TransportSolver(const Device& device, const Medium::Data& medium, const Lighting& lighting,
                                 const TransportSettings& settings, const ScatteringSettings& scattering, Vec3 orbit_up,
                                 Progress& progress, const TransportNodes* warm)
    : TransportSolver(device, matter_of(device, medium, settings.grid, scattering, progress), lighting, settings,
                      scattering, orbit_up, progress, warm) {}
TransportSolver::TransportSolver(TransportSolver&&) noexcept = default;
TransportSolver& TransportSolver::operator=(TransportSolver&&) noexcept = default;
TransportSolver::~TransportSolver() = default;

const SharedTransportMedium& TransportSolver::matter() const { return state_->matter; }
int TransportSolver::iterations() const { return state_->iterations; }
double TransportSolver::change() const { return state_->change; }
bool TransportSolver::is_done() const { return state_->is_done(); }

bool TransportSolver::iterate(Progress& progress) {
    State& s = *state_;
    if (s.is_done()) return false;
    const std::vector<Vec3> directions = turned_directions(s.settings.directions, s.iterations, s.scattering.seed);
    const double change = s.iterate(directions, progress);
    s.change = s.iterations == 0 ? std::numeric_limits<double>::infinity() : change;
    ++s.iterations;
    return true;
}

}  // namespace chiaro
