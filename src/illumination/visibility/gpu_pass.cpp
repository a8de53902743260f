// A second order of steps beside sweep.cpp, which has the same kernels: the CPU takes one batch of directions after the
// other through planes that stay in the cache, and shares out the rows of each plane; a GPU passes a plane of all
// batches side by side, a thread for each node and direction, and adds up their parts in the CPU's order afterwards.
#include "illumination/visibility/gpu_pass.h"

#include <algorithm>

#include "illumination/visibility/launch_gpu.h"
#include "illumination/visibility/sweep_pass.h"

namespace chiaro {
namespace {

constexpr std::int32_t planes_in_flight = 64;  ///< a sweep that is cancelled ends after these

/// But for density, what is seen and where it goes.
kernel::SweptNodes nodes_of(const CellGrid& grid, const SweepAxes& axes, const kernel::Harmonics& harmonics) {
    const auto [nx, ny, nz] = grid.count;
    const int steps = grid.count[axes.major];
    return {.nu = grid.count[axes.u],
            .nv = grid.count[axes.v],
            .steps = steps,
            .places = places_of(axes, steps, {1, nx, std::int64_t(nx) * ny}),
            .density = nullptr,
            .harmonics = harmonics,
            .field = nullptr,
            .seen = nullptr,
            .first = {}};
}

/// What the kernels read of a batch, as it is on the host.
class GridTables {
public:
    GridTables(const GpuField& field, const DirectionBatch& batch, const SweptDirections& all, double start)
        : axes_(batch.axes),
          row_(field.grid().count[batch.axes.u] + 2),
          packs_(batch.directions, row_, start),
          there_(packs_.data(), packs_.data() + packs_.lanes() / kernel::SweepPack::width),
          harmonics_(all, batch.directions, field.coefficients()) {}

    void add_to(HostArrays& arrays) const { packs_.add_to(arrays), arrays.add(there_), harmonics_.add_to(arrays); }
    kernel::GridSide side(const GpuField& field, cuda::Views& views) {
        for (kernel::SweepPack& pack : there_)
            views.to_device_pointers(pack.weights, pack.before, pack.outer, pack.inner);
        kernel::GridSide side{};
        side.nodes = nodes_of(field.grid(), axes_, harmonics_.view());
        side.nodes.density = field.density();
        side.packs = there_.data(), side.row = row_, side.lanes = packs_.lanes();
        views.to_device_pointers(side.packs, side.nodes.harmonics.of_direction, side.nodes.harmonics.sum);
        return side;
    }

private:
    SweepAxes axes_;
    int row_;
    SweepPacks packs_;
    std::vector<kernel::SweepPack> there_;  ///< of pointers into the GPU's memory
    BatchHarmonics harmonics_;
};

/// The density with a halo of one node, rows along x (for sweeps along y and z) or along y.
class HaloDensity {
public:
    explicit HaloDensity(const GpuField& field)
        : count_(field.grid().count),
          size_((count_[0] + 2) * std::int64_t(count_[1] + 2) * (count_[2] + 2)),
          numbers_(field.stream(), std::size_t(2 * size_)) {
        numbers_.zero();
        for (const bool across : {false, true}) {
            const Strides s = strides(across);
            kernel::run_on_gpu(
                field.stream(), std::int64_t(field.grid().size()),
                kernel::SpreadKernel{
                    count_[0], count_[1], {s[0], s[1], s[2]}, field.density(), numbers_.data() + origin(across)});
        }
    }
    const float* data() const { return numbers_.data(); }
    kernel::SweptPlaces places(const SweepAxes& axes) const {
        const bool across = axes.major == 0;
        return places_of(axes, count_[axes.major], strides(across), origin(across));
    }

private:
    using Strides = std::array<std::int64_t, 3>;
    Strides strides(bool across) const {
        const std::int64_t nx = count_[0] + 2, ny = count_[1] + 2, nz = count_[2] + 2;
        return across ? Strides{ny * nz, 1, ny} : Strides{1, nx, nx * ny};
    }
    std::int64_t origin(bool across) const {
        const Strides s = strides(across);
        return across * size_ + s[0] + s[1] + s[2];
    }

    const std::array<int, 3> count_;
    const std::int64_t size_;
    cuda::Array<float> numbers_;
};

class ShearedTables {
public:
    ShearedTables(const GpuField& field, const DirectionBatch& batch, const SweptDirections& all, double start)
        : axes_(batch.axes),
          shape_(field.grid().count[axes_.u], field.grid().count[axes_.v]),
          rays_(sheared_rays(batch.directions, field.grid().count[axes_.major], shape_.row, start)),
          harmonics_(all, batch.directions, field.coefficients()) {}

    void add_to(HostArrays& arrays) const { arrays.add(rays_), harmonics_.add_to(arrays); }
    kernel::ShearedSide side(const GpuField& field, const HaloDensity& density, cuda::Views& views) const {
        kernel::ShearedSide side{};
        side.nodes = nodes_of(field.grid(), axes_, harmonics_.view());
        side.nodes.density = density.data();
        side.with_halo = density.places(axes_);
        side.rays = rays_.data();
        side.row = shape_.row, side.origin = shape_.origin(), side.direction = shape_.direction;
        views.to_device_pointers(side.rays, side.nodes.harmonics.of_direction, side.nodes.harmonics.sum);
        return side;
    }

private:
    SweepAxes axes_;
    ShearedShape shape_;
    std::vector<kernel::ShearedDirection> rays_;
    BatchHarmonics harmonics_;
};

/// Threads of a side, by the kind of work.
template <class Side>
std::array<std::int32_t, kernel::kinds_of_work> threads_of(const Side& side) {
    const kernel::SweptNodes& nodes = side.nodes;
    return {side.numbers(), side.threads(), nodes.nu * nodes.nv * nodes.harmonics.coefficients};
}

/// The most that any of the sides needs.
template <class Side>
struct Extent {
    std::int32_t threads = 0;
    std::size_t room = 0;

    explicit Extent(const std::vector<Side>& sides) {
        for (const Side& side : sides) {
            const auto its = threads_of(side);
            threads = std::max(threads, *std::max_element(its.begin(), its.end()));
            room = std::max(room, (std::size_t(side.room()) + 31) / 32 * 32);  // whole lines of memory
        }
    }
    /// How many are swept side by side: see gpu_pass.h. Threads of a launch are counted with 31 bits.
    std::size_t together(const GpuField& field, std::size_t sides) const {
        const std::size_t each = (room + field.size()) * sizeof(float), most = field.stream().free_bytes() / 2;
        const std::size_t counted = (std::size_t(1) << 31) / (std::size_t(threads) + 1);
        return std::max<std::size_t>(1, std::min({sides, most / each, counted}));
    }
};

/// Sides next to each other, plane by plane, those with most planes first. The host waits so often that few planes are
/// ever in flight.
template <class Side>
void pass_planes(const GpuField& field, std::span<Side> sides, const cuda::Array<Side>& there,
                 const std::function<void(double)>& tell) {
    cuda::Stream& stream = field.stream();
    std::ranges::stable_sort(sides, [](const Side& a, const Side& b) { return a.nodes.steps > b.nodes.steps; });
    std::vector<std::array<std::int32_t, kernel::kinds_of_work>> ends(1);
    for (Side& side : sides) {
        ends.push_back(threads_of(side));
        for (int work = 0; work < kernel::kinds_of_work; ++work) {
            side.nodes.first[work] = ends[ends.size() - 2][work];
            ends.back()[work] += side.nodes.first[work];
        }
    }
    stream.upload(there.data(), sides.data(), sides.size() * sizeof(Side));
    const auto all = [&](std::size_t count) { return kernel::Sides<Side>{there.data(), std::int32_t(count)}; };
    kernel::run_on_gpu(stream, ends.back()[kernel::starting], kernel::StartSides<Side>{all(sides.size())});
    const std::int32_t steps = sides[0].nodes.steps;
    std::size_t count = sides.size();
    for (std::int32_t k = 0; k < steps; ++k) {
        while (sides[count - 1].nodes.steps <= k) --count;
        kernel::run_on_gpu(stream, ends[count][kernel::travelling], kernel::TravelSides<Side>{all(count), k});
        kernel::run_on_gpu(stream, ends[count][kernel::projecting], kernel::ProjectSides<Side>{all(count), k});
        if ((k + 1) % planes_in_flight != 0) continue;
        stream.wait();
        tell(double(k + 1) / steps);
    }
}

/// make_side(tables, views) of each batch. Each adds to numbers of its own, but for the first where these are floats;
/// they are added up in the order of batches, as the CPU adds them.
template <class Tables, class MakeSide>
void sweep(const GpuField& field, const SweptDirections& directions, double start, Progress& progress,
           const MakeSide& make_side) {
    using Side = std::invoke_result_t<MakeSide, Tables&, cuda::Views&>;
    cuda::Stream& stream = field.stream();
    const std::vector<SweepGroup> groups = sweep_groups(directions.towards);
    std::vector<Tables> tables;
    for (const DirectionBatch& batch : direction_batches(groups)) tables.emplace_back(field, batch, directions, start);
    HostArrays arrays;
    for (const Tables& each : tables) each.add_to(arrays);
    std::vector<Side> sides;
    cuda::Views views(stream, std::move(arrays));  // settles before what it copies from goes
    for (Tables& each : tables) sides.push_back(make_side(each, views));
    const Extent<Side> extent(sides);
    const std::size_t together = extent.together(field, sides.size());
    const cuda::Array<Side> there(stream, together);
    const cuda::Array<float> planes(stream, together * extent.room);
    const std::size_t in_place = field.is_in_steps() ? 0 : 1;  // sides that add to the field itself
    cuda::Array<float> parts(stream, std::max<std::size_t>(1, (together - in_place) * field.size()));
    for (std::size_t first = 0; first < sides.size(); first += together) {
        const std::size_t count = std::min(together, sides.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            Side& side = sides[first + i];
            side.take(planes.data() + i * extent.room);
            side.nodes.field = i < in_place ? field.data() : parts.data() + (i - in_place) * field.size();
        }
        parts.zero();
        pass_planes<Side>(field, std::span(sides).subspan(first, count), there, [&](double share) {
            progress.report("visibility", (double(first) + share * double(count)) / double(sides.size()));
            progress.check();
        });
        if (count > in_place) field.add(parts.data(), std::int32_t(count - in_place));
        progress.check();
    }
    stream.wait();
    progress.report("visibility", 1);
}

}  // namespace

void grid_sweep_on_gpu(const GpuField& field, const SweptDirections& directions, double start, Progress& progress) {
    sweep<GridTables>(field, directions, start, progress,
                      [&](GridTables& tables, cuda::Views& views) { return tables.side(field, views); });
}

void sheared_sweep_on_gpu(const GpuField& field, const SweptDirections& directions, double start, Progress& progress) {
    const HaloDensity density(field);
    sweep<ShearedTables>(field, directions, start, progress, [&](const ShearedTables& tables, cuda::Views& views) {
        return tables.side(field, density, views);
    });
}

}  // namespace chiaro
