// A second order of steps beside solver.cpp and uncollided_light.cpp, which have the same kernels: the CPU sweeps one
// group of directions for each thread, by rows whose planes stay in the cache; a GPU passes one plane of all groups at
// a time, a thread for each cell. What is done cell by cell around the sweeps is told once (dominant_light.h, grid.cpp,
// boundary_cells.cpp, matter.cpp).
#include "illumination/transport/gpu.h"

#include <algorithm>

#include "core/srgb.h"
#include "cuda/device_cache.h"
#include "illumination/transport/batches.h"
#include "illumination/transport/dominant_light.h"
#include "illumination/transport/launch_gpu.h"
#include "illumination/visibility/sweep.h"

namespace chiaro {
namespace {

constexpr int sides = 6;

void swap_pointers(cuda::Views& views, kernel::FirstSweepKernel& kernel) {
    views.to_device_pointers(kernel.rays, kernel.basis, kernel.octants, kernel.per_share, kernel.on_faces);
}
void swap_pointers(cuda::Views& views, kernel::SourceSweepKernel& kernel) {
    views.to_device_pointers(kernel.rays, kernel.octants, kernel.open_weight, kernel.cosine);
}

/// Numbers in a row of a travelling plane, with its halo.
int pitch_of(const SweptMedium& medium, const SweepAxes& axes) { return medium.lattices.along_x.count()[axes.u] + 2; }

}  // namespace

GpuTransport::GpuTransport(const Device& device, const SweptMedium& medium)
    : stream_(device.stream),
      medium_(medium),
      places_(cell_places(medium.lattices.along_x, medium.lattices.along_y)),
      field_(std::max(medium.lattices.along_x.size(), medium.lattices.along_y.size())),
      extinction_(fields(2)),
      albedo_(fields(3)),
      first_light_(fields(3)),
      first_moment_(fields(9)),
      source_(fields(3)),
      across_(fields(3)),
      mean_(fields(3)),
      moment_(fields(9)),
      sums_(fields(kernel::SourceSweepKernel::sums * sides)),
      arriving_(*stream_, sides * std::max<std::size_t>(1, medium.opaque.count()) * kernel::cell_floats),
      first_faces_(of_faces()),
      faces_(of_faces()),
      mean_faces_(of_faces()),
      emission_(*stream_,
                std::max<std::size_t>(1, medium.opaque.listed() * OpaqueCells::octants) * kernel::face_floats),
      change_(*stream_, 2 * std::size_t(places_.count())),
      change_sums_(*stream_, std::size_t(places_.nz) * 2 * kernel::ChangeKernel::lanes),
      reflect_(medium.opaque.reflect_kernel(faces_.data(), emission_.data())),
      cover_(medium.opaque.cover_kernel(emission_.data())) {
    const std::vector<std::int32_t> ids = medium.opaque.ids_with_halo();
    const cuda::SyncOnExit sync{*stream_};
    HostArrays arrays;
    medium.opaque.add_to(arrays), arrays.add(ids);
    tables_ = std::make_unique<cuda::Views>(*stream_, std::move(arrays));
    clear_ = medium.opaque.clear_cells(), ids_ = ids.data(), around_ = medium.opaque.around().data();
    tables_->to_device_pointers(clear_, ids_, around_, reflect_.open, reflect_.reflectance, cover_.covers);
    for (Numbers* zero :
         {&extinction_, &albedo_, &emission_, &moment_, &first_light_, &first_moment_, &source_, &mean_, &first_faces_})
        zero->zero();  // beside the cells, where the host's fields are zero
    run(cells(),
        kernel::LatticeKernel{places_, medium.grid.extinction.on_gpu(*stream_), medium.grid.albedo.on_gpu(*stream_),
                              medium.grid.surface_share ? medium.grid.surface_share->on_gpu(*stream_) : nullptr,
                              medium.grid.resolves_skins, clear_, ids_, std::int64_t(field_), extinction_.data(),
                              albedo_.data()});
    stream_->wait();
}

GpuTransport::Numbers GpuTransport::fields(int count) const { return {*stream_, field_ * std::size_t(count)}; }

GpuTransport::Numbers GpuTransport::of_faces() const {
    return {*stream_, std::max<std::size_t>(1, medium_.opaque.count()) * kernel::cell_floats};
}

void GpuTransport::download(LatticeField& to, const Numbers& from, int i) const {
    to = medium_.lattices.along_x.unset_field();
    stream_->download(to.data(), field(from, i), to.size() * sizeof(float));
}
void GpuTransport::upload(const Numbers& to, const Faces& from) {
    stream_->upload(to.data(), from.data(), from.size() * sizeof from[0]);
}
GpuTransport::Faces GpuTransport::faces_of(const Numbers& numbers) const {
    Faces faces(medium_.opaque.count());
    stream_->download(faces.data(), numbers.data(), faces.size() * sizeof faces[0]);
    stream_->wait();
    return faces;
}

template <class Kernel>
void GpuTransport::run(std::size_t count, const Kernel& kernel) const {
    kernel::run_on_gpu(*stream_, std::int64_t(count), kernel);
}

/// The cells of a group, but for what travels.
kernel::SweptCells GpuTransport::cells_of(const SweepAxes& axes) const {
    const Lattice& lattice = medium_.lattices.of(axes);
    const OpaqueCells& opaque = medium_.opaque;
    const auto& n = lattice.count();
    const auto to = [&](int x, int y, int z) { return std::int64_t(lattice.index(x, y, z)); };
    kernel::SweptCells cells{};
    cells.nu = n[axes.u], cells.nv = n[axes.v], cells.steps = n[axes.major];
    cells.in_field = places_of(axes, cells.steps, {to(1, 0, 0), to(0, 1, 0), to(0, 0, 1)});
    cells.in_halo =
        places_of(axes, cells.steps, {opaque.stride(0), opaque.stride(1), opaque.stride(2)}, opaque.bit_index(0, 0, 0));
    cells.extinction = field(extinction_, lattice.along_y());
    cells.ids = ids_, cells.around = around_;
    cells.opaque = {nullptr, 0, std::int32_t(opaque.count()), std::int32_t(opaque.listed()), emission_.data(), nullptr};
    cells.pitch = pitch_of(medium_, axes);
    return cells;
}

/// Batches of a group that are on their way at once: as many as half of the free memory holds planes for, one at least.
template <class Batch>
GpuTransport::Rounds GpuTransport::rounds_of(const std::vector<SweepGroup>& groups,
                                             const std::vector<std::vector<Batch>>& batches, int per_ray) const {
    Rounds rounds{};
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const kernel::SweptCells of = cells_of(groups[g].axes);
        rounds.plane = std::max(rounds.plane, std::size_t(of.pitch) * (of.nv + 2) * per_ray * Batch::Kernel::max_rays);
        rounds.all = std::max(rounds.all, batches[g].size());
    }
    rounds.planes = 2 * rounds.plane * groups.size();
    rounds.together =
        std::clamp<std::size_t>(stream_->free_bytes() / 2 / (rounds.planes * sizeof(float)), 1, rounds.all);
    return rounds;
}

/// Groups side by side, and batches of a group each a plane behind the one whose sums it adds to. make_side(g, batch,
/// is_first) tells all but what travels; `then` starts what reads the sums, unless the sweep is cancelled. Waits once.
template <class Batch, class MakeSide, class Then>
void GpuTransport::sweep(const std::vector<SweepGroup>& groups, const std::vector<std::vector<Batch>>& batches,
                         const MakeSide& make_side, const SweepTerms& terms, const Then& then, Progress& progress) {
    const Rounds rounds = rounds_of(groups, batches, terms.per_ray);
    HostArrays arrays;
    for (const auto& of_group : batches)
        for (const Batch& batch : of_group) batch.add_to(arrays);
    std::vector<std::vector<decltype(make_side(0, batches[0][0], true))>> passes((rounds.all - 1) / rounds.together +
                                                                                 1);
    cuda::Views views(*stream_, std::move(arrays));  // settles before `passes` go
    const Numbers planes(*stream_, rounds.together * rounds.planes);
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (std::size_t round = 0; round < batches[g].size(); ++round) {
            auto& side = passes[round / rounds.together].emplace_back(make_side(g, batches[g][round], round == 0));
            const std::size_t behind = round % rounds.together;
            swap_pointers(views, side.kernel);
            side.cells.behind = std::int32_t(behind);
            side.cells.numbers = terms.per_ray * batches[g][round].count();
            side.cells.opaque.arriving = arriving_.data() + g * medium_.opaque.count() * kernel::cell_floats;
            for (std::size_t i = 0; i < 2; ++i)
                side.cells.planes[i] = planes.data() + behind * rounds.planes + (2 * g + i) * rounds.plane;
        }
    arriving_.zero();
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
        run(planes.size(), kernel::FillKernel{planes.data(), terms.outside});
        pass_planes(passes[pass]);
        progress.report(terms.stage, double(pass + 1) / double(passes.size()));
        progress.check();
    }
    then();
    stream_->wait();
}

template <class Side>
void GpuTransport::pass_planes(const std::vector<Side>& sides) {
    const cuda::Array<Side> on_gpu(*stream_, sides.size());
    stream_->upload(on_gpu.data(), sides.data(), sides.size() * sizeof sides[0]);
    std::int32_t widest = 0, launches = 0;
    for (const Side& side : sides) {
        widest = std::max(widest, side.cells.nu * side.cells.nv);
        launches = std::max(launches, side.cells.steps + side.cells.behind);
    }
    for (std::int32_t k = 0; k < launches; ++k)
        run(sides.size() * std::size_t(widest), kernel::SweepPlaneKernel<Side>{on_gpu.data(), widest, k});
}

void GpuTransport::find_first(const FirstDirections& first, Progress& progress) {
    constexpr int sums = kernel::AddUpKernel::sums;
    const std::vector<SweepGroup> groups = sweep_groups(first.directions);
    std::vector<std::vector<FirstBatch>> batches(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (SweepBatch& batch : sweep_batches(first.directions, groups[g], FirstBatch::Kernel::max_rays,
                                               pitch_of(medium_, groups[g].axes)))
            batches[g].emplace_back(std::move(batch), first.directions, first.incident);
    const Numbers parts = fields(sums * int(groups.size()));
    const auto side = [&](std::size_t g, const FirstBatch& batch, bool is_first) {
        kernel::FirstSide made{cells_of(groups[g].axes), batch.kernel(is_first), {}};
        for (int s = 0; s < sums; ++s) made.sums[s] = field(parts, int(g) * sums + s);
        return made;
    };
    kernel::AddUpKernel add{places_, parts.data(), std::int64_t(field_), std::int32_t(groups.size()),
                            0,       {},           first_light_.data(),  first_moment_.data()};
    for (std::size_t g = 0; g < groups.size(); ++g) add.across |= int(groups[g].axes.major == 0) << g;
    for (int c = 0; c < 3; ++c) add.luminance[c] = float(luminance_weights[c]);
    const auto add_up = [&] {
        run(cells(), add);
        meet_faces(groups.size(), first_faces_, nullptr, nullptr, 0);
    };
    sweep(groups, batches, side, {1, 1, "light"}, add_up, progress);
}

void GpuTransport::add_dominant_light(const Device& device, const DominantLight& dominant, Progress& progress) {
    const GpuField seen = sweep_on_gpu(device, medium_.grid.extinction, std::vector{dominant.direction},
                                       dominant_coefficients, dominant_start, SweepLattice::sheared, progress);
    SunPlaces places{seen.data(), seen.density(), clear_, ids_, around_, first_faces_.data(), {}, {}};
    for (int c = 0; c < 3; ++c) {
        places.light[c] = field(first_light_, c);
        for (int axis = 0; axis < 3; ++axis) places.moment[c][axis] = field(first_moment_, 3 * c + axis);
    }
    GpuExecutor executor(stream_);
    shine(executor, medium_, dominant, places);
}

void GpuTransport::start(const Device& device, const FirstDirections& first, Progress& progress) {
    find_first(first, progress);
    if (first.incident.dominant) add_dominant_light(device, *first.incident.dominant, progress);
    for (const Numbers* faces : {&faces_, &mean_faces_})
        stream_->copy(faces->data(), first_faces_.data(), faces->size() * sizeof(float));
    run(cells(), kernel::StartKernel{places_, albedo_.data(), first_light_.data(), std::int64_t(field_), source_.data(),
                                     mean_.data()});
    turn_and_reflect();
    stream_->wait();
}

void GpuTransport::start_from(kernel::NearestKernel nearest, HostArrays arrays, const Faces& faces) {
    cuda::Views views(*stream_, std::move(arrays));
    views.to_device_pointers(nearest.light, nearest.nearest[0], nearest.nearest[1], nearest.nearest[2]);
    const cuda::SyncOnExit sync{*stream_};
    upload(faces_, faces);
    for (int c = 0; c < 3; ++c) nearest.albedo[c] = field(albedo_, c), nearest.source[c] = field(source_, c);
    run(cells(), nearest);
    turn_and_reflect();
    stream_->wait();
}

template <class Then>
void GpuTransport::scatter(const std::vector<Vec3>& directions, const Then& then, Progress& progress) {
    constexpr int channels = SourceBatch::Kernel::channels, per_side = SourceBatch::Kernel::sums;
    const std::vector<SweepGroup> groups = sweep_groups(directions);
    std::vector<std::vector<SourceBatch>> batches(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (SweepBatch& batch : sweep_batches(directions, groups[g], SourceBatch::Kernel::max_rays,
                                               channels * pitch_of(medium_, groups[g].axes)))
            batches[g].emplace_back(std::move(batch), directions, groups[g].axes);
    const auto side = [&](std::size_t g, const SourceBatch& batch, bool is_first) {
        const SweepAxes& axes = groups[g].axes;
        kernel::SourceSide made{cells_of(axes), batch.kernel(directions.size(), is_first), {}, {}};
        for (int c = 0; c < channels; ++c)
            made.source[c] = field(medium_.lattices.of(axes).along_y() ? across_ : source_, c);
        for (int s = 0; s < per_side; ++s) made.sums[s] = field(sums_, per_side * side_of(axes) + s);
        return made;
    };
    if (groups.size() < sides) sums_.zero();  // few directions: no light came from some sides
    const auto with_groups = [&] { then(groups.size()); };
    sweep(groups, batches, side, {channels, 0, "scattering"}, with_groups, progress);
}

void GpuTransport::meet_faces(std::size_t groups, const Numbers& faces, const Numbers* first, const Numbers* mean,
                              float share) {
    run(medium_.opaque.count() * OpaqueCells::faces,
        kernel::FaceKernel{arriving_.data(), std::int64_t(medium_.opaque.count()) * kernel::cell_floats,
                           std::int32_t(groups), first ? first->data() : nullptr, faces.data(),
                           mean ? mean->data() : nullptr, share});
}

/// What sweeps read, once the source and the faces are known.
void GpuTransport::turn_and_reflect() {
    run(cells(), kernel::TurnKernel{places_, std::int64_t(field_), source_.data(), across_.data()});
    run(medium_.opaque.count() * OpaqueCells::octants, reflect_);
    run(medium_.opaque.covers(), cover_);
}

std::vector<float> GpuTransport::iterate(const std::vector<Vec3>& directions, const kernel::UpdateKernel& update,
                                         Progress& progress) {
    std::vector<float> sums(change_sums_.size());
    const cuda::SyncOnExit sync{*stream_};
    const auto follow = [&](std::size_t groups) {
        run(cells(), kernel::UpdateCellKernel{places_, update, std::int64_t(field_), extinction_.data(), albedo_.data(),
                                              first_light_.data(), sums_.data(), source_.data(), mean_.data(),
                                              moment_.data(), change_.data()});
        run(change_sums_.size(), kernel::ChangeKernel{places_, change_.data(), change_sums_.data()});
        meet_faces(groups, faces_, &first_faces_, &mean_faces_, update.share);
        turn_and_reflect();
        stream_->download(sums.data(), change_sums_.data(), sums.size() * sizeof(float));
    };
    scatter(directions, follow, progress);
    return sums;
}

/// By way of what holds the sums of a sweep, which are no one's between sweeps.
void GpuTransport::nodes(std::vector<float>& light, std::vector<float>& moment) const {
    kernel::NodeKernel gather{places_, {}, {}, {}, sums_.data(), sums_.data() + light.size()};
    for (int c = 0; c < 3; ++c) {
        gather.mean[c] = field(mean_, c);
        for (int axis = 0; axis < 3; ++axis) {
            gather.moment[c][axis] = field(moment_, 3 * c + axis);
            gather.first_moment[c][axis] = field(first_moment_, 3 * c + axis);
        }
    }
    run(cells(), gather);
    const cuda::SyncOnExit sync{*stream_};
    stream_->download(light.data(), gather.light, light.size() * sizeof(float));
    stream_->download(moment.data(), gather.moments, moment.size() * sizeof(float));
    stream_->wait();
}

void GpuTransport::scattered(std::vector<float>& scattered) const {
    kernel::ScatteredNodeKernel gather{places_, {}, {}, {}, sums_.data()};
    for (int c = 0; c < 3; ++c) {
        gather.mean[c] = field(mean_, c), gather.first[c] = field(first_light_, c);
        for (int axis = 0; axis < 3; ++axis) gather.moment[c][axis] = field(moment_, 3 * c + axis);
    }
    run(cells(), gather);
    const cuda::SyncOnExit sync{*stream_};
    stream_->download(scattered.data(), gather.scattered, scattered.size() * sizeof(float));
    stream_->wait();
}

void GpuTransport::fetch(LightFields& fields) const {
    const cuda::SyncOnExit sync{*stream_};
    for (int c = 0; c < 3; ++c) {
        download(fields.first.light[c], first_light_, c);
        download(fields.source[c], source_, c), download(fields.mean[c], mean_, c);
        for (int axis = 0; axis < 3; ++axis) {
            download(fields.first.moment[c][axis], first_moment_, 3 * c + axis);
            download(fields.moment[c][axis], moment_, 3 * c + axis);
        }
    }
    fields.first.faces = faces_of(first_faces_), fields.faces = faces(), fields.mean_faces = mean_faces();
    stream_->wait();
}

}  // namespace chiaro
