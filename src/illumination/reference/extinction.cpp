#include "illumination/reference/extinction.h"

#include <chiaro/error.h>

#include <mutex>

#include "core/threads.h"
#include "cuda/run.h"
#include "illumination/cells/gpu.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

constexpr double max_opaque = 1 - 1e-7;  ///< κ = -ln(1 - α) stays finite

double extinction_of(double opacity) { return -std::log1p(-std::min(opacity, max_opaque)); }

/// By opacity of cells of isosurfaces.
std::vector<float> by_opacity() {
    std::vector<float> entries;
    for (int opacity = 0; opacity <= int(cell_one); ++opacity)
        entries.push_back(float(extinction_of(opacity / double(cell_one))));
    return entries;
}

template <class Voxel>
kernel::CellExtinction<Voxel> extinction_in(const Medium::Data& medium, const CellOpacity& opacity,
                                            const ExtinctionTable& table) {
    const auto [nx, ny, nz] = opacity.values.grid.count;
    return {.volume = view_of<Voxel>(medium.volume.data()),
            .cells = cell_centres(medium, opacity.values.grid),
            .opacity = medium.shape.mode == Mode::iso ? opacity.values.address() : nullptr,
            .entries = table.per_edge.data(),
            .scale = table.index_scale,
            .offset = table.index_offset,
            .last = float(table.per_edge.size() - 1),
            .count = {nx, ny, nz},
            .edge_mm = float(opacity.values.grid.edge_mm)};
}

void swap_pointers(cuda::Views& views, kernel::NodeExtinction& extinction) {
    views.to_device_pointers(extinction.density);
}
template <class Voxel>
void swap_pointers(cuda::Views& views, kernel::CellExtinction<Voxel>& extinction) {
    swap_pointers(views, extinction.volume);
    views.to_device_pointers(extinction.opacity, extinction.entries);
}

ExtinctionTable inside_surfaces(const Medium::Data& medium) {
    constexpr int steps = 65536;  // all stored values of 16 bits, and as fine as single precision needs
    const DeviceVolume::Data& volume = medium.volume.data();
    const double low = volume.stored_min, per_step = std::max((volume.stored_max - low) / steps, 1e-30);
    ExtinctionTable table{{}, float(1 / per_step), float(-low / per_step)};
    for (int j = 0; j <= steps; ++j) {
        const double value = volume.scale * (low + j * per_step) + volume.offset;
        double clear = 1;
        for (const IsoSurface& s : medium.shape.iso) clear *= value >= s.value ? 1 - s.opacity : 1;
        table.per_edge.push_back(float(extinction_of(1 - clear)));
    }
    return table;
}

}  // namespace

ExtinctionTable extinction_table(const Medium::Data& medium, const CellGrid& grid) {
    if (medium.shape.mode == Mode::iso) return inside_surfaces(medium);
    return {extinction_per_edge(medium, grid), float(medium.table.index_scale), float(medium.table.index_offset)};
}

ExtinctionCells::ExtinctionCells(const CellGrid& grid, int stride) {
    for (int axis = 0; axis < 3; ++axis) count_[axis] = (grid.count[axis] + stride - 1) / stride * stride;
    const int phase = count_[0] / stride + gap;
    const double row = double(phase) * stride, all = row * count_[1] * count_[2] + 2 * gap;
    if (all > 2147483647.0)
        throw Error(ErrorCode::output,
                    "rays through the volume would need more than 2147483647 cells: resample the volume, or choose "
                    "another lighting method");
    layout_ = {stride, phase, int(row), int(row) * count_[1]};
    buffer_ = MirroredBuffer(std::size_t(all) * sizeof(float));
}

ExtinctionCells::ExtinctionCells(const Medium::Data& medium, const CellOpacity& opacity, int stride,
                                 const Device& device, Progress& progress)
    : ExtinctionCells(opacity.values.grid, stride) {
    const bool is_iso = medium.shape.mode == Mode::iso;
    const ExtinctionTable table =
        is_iso ? ExtinctionTable{by_opacity()} : extinction_table(medium, opacity.values.grid);
    HostArrays arrays;
    medium.volume.data().add_to(arrays), arrays.add(table.per_edge);
    if (is_iso) arrays.add(opacity.values.buffer.array());
    with_stored_voxel(medium.volume.data(), [&](auto voxel) {
        fill(opacity.values.grid, opacity.matter, extinction_in<decltype(voxel)>(medium, opacity, table), arrays,
             device, progress);
    });
}

ExtinctionCells::ExtinctionCells(const Density& density, int stride, const Device& device, Progress& progress)
    : ExtinctionCells(density.grid, stride) {
    const auto [nx, ny, nz] = density.grid.count;
    HostArrays arrays;
    arrays.add(density.buffer.array());
    const auto* numbers = reinterpret_cast<const float*>(density.buffer.address());
    fill(density.grid, BlockMap(density.grid.count, true), kernel::NodeExtinction{numbers, {nx, ny, nz}}, arrays,
         device, progress);
}

void ExtinctionCells::Range::add(int x, int y, int z, kernel::RowSpan span) {
    if (span.end) add({{x + span.first, y, z}, {x + span.end - 1, y, z}});
}
void ExtinctionCells::Range::add(const Range& other) {
    if (other.high[0] < 0) return;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = high[axis] < 0 ? other.low[axis] : std::min(low[axis], other.low[axis]);
        high[axis] = std::max(high[axis], other.high[axis]);
    }
}

template <class Extinction>
void ExtinctionCells::fill(const CellGrid& grid, const BlockMap& blocks, const Extinction& extinction,
                           const HostArrays& arrays, const Device& device, Progress& progress) {
    const auto [nx, ny, nz] = grid.count;
    const kernel::ExtinctionRow<Extinction> row{extinction, layout_, {nx, ny, nz}, nullptr};
    if (cuda::try_gpu(device, [&] { fill_there(row, blocks, arrays, device, progress); })) return;
    arrays.fetch();
    fill_here(row, grid, blocks, device, progress);
}

template <class Extinction>
void ExtinctionCells::fill_here(const kernel::ExtinctionRow<Extinction>& unplaced, const CellGrid& grid,
                                const BlockMap& blocks, const Device& device, Progress& progress) {
    auto row = unplaced;
    row.out = reinterpret_cast<float*>(buffer_.data()) + gap;
    Range held;
    std::mutex merging;
    const auto order = blocks.held();
    const auto work = [&](std::int64_t b, std::int64_t) {
        Range its;
        const auto [x, y, z] = blocks.cells(order[b], grid.count);
        for (int k = z.first; k < z.second; ++k)
            for (int j = y.first; j < y.second; ++j) its.add(x.first, j, k, row(x.first, j, k));
        const std::lock_guard lock(merging);
        held.add(its);
    };
    parallel_for(device.threads, std::int64_t(order.size()), 1, "extinction", progress, work);
    progress.check();
    held_ = held;
}

template <class Extinction>
void ExtinctionCells::fill_there(kernel::ExtinctionRow<Extinction> row, const BlockMap& blocks,
                                 const HostArrays& arrays, const Device& device, Progress& progress) {
    using Fill = kernel::FillExtinction<Extinction>;
    cuda::Stream& stream = *device.stream;
    cuda::Views views(stream, arrays);
    swap_pointers(views, row.extinction);
    cuda::Array<std::byte> made(stream, buffer_.size());
    made.zero();
    row.out = reinterpret_cast<float*>(made.data()) + gap;
    const cuda::Array<kernel::RowSpan> spans(stream, blocks_together * Fill::rows);
    std::vector<kernel::RowSpan> found;
    Range held;
    const auto order = blocks.held();
    auto block = order.begin();
    for_blocks(stream, blocks, "extinction", progress, [&](const kernel::BlockPlace* places, std::int64_t count) {
        kernel::run_on_gpu(stream, count * Fill::rows, Fill{row, places, spans.data()});
        found.resize(std::size_t(count) * Fill::rows);
        stream.fetch(found.data(), spans.data(), found.size() * sizeof found[0]);
        for (auto span = found.begin(); span != found.end(); ++block) {
            const auto [x, y, z] = blocks.at(*block);
            for (int i = 0; i < Fill::rows; ++i, ++span)
                held.add(x * block_edge, y * block_edge + i % block_edge, z * block_edge + i / block_edge, *span);
        }
    });
    buffer_.keep(device.stream, made.data());
    held_ = held;
}

}  // namespace chiaro
