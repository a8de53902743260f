#include "illumination/cells/opacity.h"

#include <optional>

#include "core/threads.h"
#include "illumination/cells/classifier.h"
#include "illumination/cells/gpu.h"
#include "illumination/cells/launch_gpu.h"

namespace chiaro {
namespace {

CellValues classify_cells(const Device& device, const Medium::Data& medium, const OpacityMaps& maps,
                          Progress& progress) {
    CellValues values(maps.grid);
    const auto fill = opacity_filler(medium, maps, rows_of(values));
    const auto blocks = maps.matter.held();
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "opacity", progress,
                 [&](std::int64_t b, std::int64_t) {
                     const auto [x, y, z] = maps.matter.at(blocks[b]);
                     fill({x, y}, z * block_edge, std::min((z + 1) * block_edge, maps.grid.count[2]));
                 });
    progress.check();
    return values;
}

/// Where voxels and occupancy are, the opacities stay too.
template <class Voxel>
CellValues classify_on_gpu(const Device& device, const Medium::Data& medium, const OpacityMaps& maps,
                           Progress& progress) {
    const DeviceVolume::Data& volume = medium.volume.data();
    cuda::Stream& stream = *device.stream;
    const CellGrid& grid = maps.grid;
    GpuCells made(device, grid);
    const auto entries = opacity_entries(medium, grid);
    HostArrays arrays;
    volume.add_to(arrays), arrays.add(entries);
    cuda::Views views(stream, std::move(arrays));
    const auto [nx, ny, nz] = grid.count;
    kernel::OpacityBatch<Voxel> batch{
        opacity_kernel<Voxel>(medium, grid, entries), nullptr, {nx, ny, nz}, false, made.data()};
    swap_pointers(views, batch.kernel.volume);
    views.to_device_pointers(batch.kernel.entries);
    const auto fill = [&](const BlockMap& map, bool near_surface) {
        batch.near_surface = near_surface;
        for_blocks(stream, map, "opacity", progress, [&](const kernel::BlockPlace* places, std::int64_t blocks) {
            batch.places = places;
            kernel::fill_opacities(stream, batch, blocks);
        });
    };
    BlockMap hidden = maps.matter;
    for (std::size_t b = 0; b < hidden.holds.size(); ++b) hidden.holds[b] &= !maps.visible.holds[b];
    fill(hidden, false), fill(maps.visible, true);
    return made.release();
}

}  // namespace

std::vector<float> extinction_per_edge(const Medium::Data& medium, const CellGrid& grid) {
    std::vector<float> kappa;
    for (const OpticalTable::Entry& entry : medium.table.entries)
        kappa.push_back(float(entry.extinction_per_mm * grid.edge_mm));
    return kappa;
}

CellOpacity cell_opacity(const Medium::Data& medium, Progress& progress) {
    return cell_opacity(medium.volume.data().device, medium, progress);
}

OpacityMaps opacity_maps(const Medium::Data& medium) {
    const DeviceVolume::Data& volume = medium.volume.data();
    const CellGrid grid = make_cell_grid(volume.dimensions, volume.geometry);
    BlockMap visible = visible_blocks(medium, grid, 1);
    // Nothing is seen inside a surface, but it is matter.
    BlockMap matter = medium.shape.mode == Mode::iso ? BlockMap(grid.count, true) : visible;
    return {grid, std::move(matter), std::move(visible)};
}

SliceWork opacity_filler(const Medium::Data& medium, const OpacityMaps& maps, const RowsOf<std::uint16_t>& to) {
    SliceWork filler;
    with_stored_voxel(medium.volume.data(), [&](auto voxel) {
        const auto classifier = std::make_shared<CellClassifier<decltype(voxel)>>(medium, maps.grid, to);
        filler = [classifier, &maps, to](std::array<int, 2> column, int first, int end) {
            for (int k = first; k < end; ++k) {
                const std::size_t block = maps.matter.index(column[0], column[1], k / block_edge);
                const bool is_matter = maps.matter.holds[block];
                if (!is_matter && to.holds_all()) continue;
                const auto [x, y, z] = maps.matter.cells(block, to.count);
                for (int j = y.first; j < y.second; ++j) {
                    // Rows lie too far apart for the processor to guess the next one: a slice ahead.
                    __builtin_prefetch(to.row(j, std::min(k + 1, end - 1)) + x.first, 1);
                    if (is_matter)
                        classifier->fill(x.first, x.second, j, k, maps.visible.holds[block]);
                    else
                        std::fill_n(to.row(j, k) + x.first, x.second - x.first, std::uint16_t(0));
                }
            }
        };
    });
    return filler;
}

CellOpacity cell_opacity(const Device& device, const Medium::Data& medium, Progress& progress) {
    OpacityMaps maps = opacity_maps(medium);
    std::optional<CellValues> values;
    const auto on_gpu = [&] {
        with_stored_voxel(medium.volume.data(), [&](auto voxel) {
            values.emplace(classify_on_gpu<decltype(voxel)>(device, medium, maps, progress));
        });
    };
    if (!cuda::try_gpu(device, on_gpu)) values.emplace(classify_cells(device, medium, maps, progress));
    return {*std::move(values), std::move(maps.matter), std::move(maps.visible)};
}

}  // namespace chiaro
