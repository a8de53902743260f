#include "illumination/cells/opacity.h"

#include <cstring>
#include <optional>

#include "classify/medium.h"
#include "core/threads.h"
#include "illumination/cells/gpu.h"
#include "illumination/cells/launch_gpu.h"
#include "illumination/cells/launch_values.h"
#include "volume/device_view.h"
#include "volume/float3.h"
#include "volume/occupancy.h"

namespace chiaro {
namespace {

/// Opacities by entry of the optical table; none of isosurfaces.
std::vector<std::uint16_t> opacity_entries(const Medium::Data& medium, const CellGrid& grid) {
    std::vector<std::uint16_t> entries;
    if (medium.shape.mode == Mode::iso) return entries;
    for (float kappa : extinction_per_edge(medium, grid)) entries.push_back(cell_value(-std::expm1(-kappa)));
    return entries;
}

kernel::CoverageView coverage_view(const Medium::Data& medium, const CellGrid& grid) {
    static_assert(max_isosurfaces <= kernel::CoverageView::max_surfaces);
    const DeviceVolume::Data& volume = medium.volume.data();
    kernel::CoverageView view{.values = {},
                              .opacities = {},
                              .count = 0,
                              .inwards = volume.scale < 0 ? -1.0f : 1.0f,
                              .per_edge = float3(grid.voxels_per_cell)};
    for (const IsoSurface& s : medium.shape.iso) {
        view.values[view.count] = float((s.value - volume.offset) / volume.scale);
        view.opacities[view.count++] = float(s.opacity);
    }
    return view;
}

template <class Voxel>
kernel::CellOpacityKernel<Voxel> opacity_kernel(const Medium::Data& medium, const CellGrid& grid,
                                                const std::vector<std::uint16_t>& entries) {
    return {.volume = view_of<Voxel>(medium.volume.data()),
            .cells = cell_centres(medium, grid),
            .entries = entries.empty() ? nullptr : entries.data(),
            .scale = float(medium.table.index_scale),
            .offset = float(medium.table.index_offset + 0.5),
            .last = float(entries.size()) - 1,
            .surfaces = coverage_view(medium, grid),
            .edge_mm = float(grid.edge_mm),
            .labels = label_view(medium.surface_labels.get())};
}

/// Fills rows of cells from a volume of one stored type.
template <class Voxel>
class CellClassifier {
public:
    CellClassifier(const Medium::Data& medium, const CellGrid& grid, const RowsOf<std::uint16_t>& out)
        : out_(out),
          entries_(opacity_entries(medium, grid)),
          kernel_(opacity_kernel<Voxel>(medium, grid, entries_)),
          occupancy_{medium.cells.data(), medium.volume.data().cells.count[0], medium.volume.data().cells.count[1]},
          find_values_(kernel::value_row_for<Voxel>(medium.volume.data().device.isa)) {
        if (!entries_.empty() && sizeof(Voxel) <= 2)
            for (std::size_t v = 0; v < std::size_t(1) << (8 * sizeof(Voxel)); ++v)
                of_stored_.push_back(kernel_.of_stored(float(v)));
        for (int x = 0; !kernel_.cells.are_voxels && x < grid.count[0] + lanes; ++x) {
            along_x_.push_back(float(kernel_.cells.along(0, x)));
            occupied_x_.push_back(kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(x, 0, 0))).x >> cell_bits);
        }
    }

    /// Cells [x0, x1) of a row.
    void fill(int x0, int x1, int y, int z, bool near_surface) {
        std::uint16_t* row = out_.row(y, z);
        if (!kernel_.entries)
            for (int x = x0; x < x1; ++x) row[x] = kernel_.inside(x, y, z, near_surface);
        else if (kernel_.cells.are_voxels && (kernel_.volume.has_factor() || kernel_.volume.is_mixed()))
            for (int x = x0; x < x1; ++x) row[x] = is_seen(x, y, z) ? kernel_.of_voxel(x, y, z) : 0;
        else if (kernel_.cells.are_voxels)
            copy_row(x0, x1, y, z, row);
        else if (kernel_.volume.has_factor() || kernel_.volume.is_mixed())
            for (int x = x0; x < x1; ++x) row[x] = is_seen(x, y, z) ? kernel_.between_voxels(x, y, z) : 0;
        else
            for (int x = x0; x < x1; x += lanes) fill_between_voxels(x, std::min(x + lanes, x1), y, z, row);
        for (int x = x0; kernel_.cells.plane_count > 0 && x < x1; ++x)
            if (kernel_.cells.is_clipped(x, y, z)) row[x] = 0;
    }

private:
    /// Whether anything may be seen around a cell; where nothing is, no value needs to be found.
    bool is_seen(int x, int y, int z) const {
        const auto voxel = kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(x, y, z)));
        return occupancy_.cells[occupancy_.index<float>(voxel)] & 1;
    }

    /// The same for some cells side by side, whose values are found together.
    void fill_between_voxels(int x0, int x1, int y, int z, std::uint16_t* row) const {
        const auto first = kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(0, y, z)));
        const std::uint8_t* occupied = occupancy_.cells + occupancy_.index<float>({0, first.y, first.z});
        std::uint8_t seen[lanes], any = 0;
        for (int i = 0; i < lanes; ++i) any |= seen[i] = occupied[occupied_x_[std::size_t(x0 + i)]] & 1;
        if (!any) return void(std::fill(row + x0, row + x1, std::uint16_t(0)));
        float values[lanes];
        find_values_(kernel_.volume, {&along_x_[std::size_t(x0)], float(kernel_.cells.along(1, y)),
                                      float(kernel_.cells.along(2, z)), lanes, values});
        std::int32_t entry[lanes];
        for (int i = 0; i < lanes; ++i) entry[i] = kernel_.entry_of(values[i]);
        for (int x = x0; x < x1; ++x) row[x] = seen[x - x0] ? entries_[std::size_t(entry[x - x0])] : 0;
    }

    /// Straight through the bricks: voxel i lies in the brick of interval min(i, n - 2).
    void copy_row(int x0, int x1, int y, int z, std::uint16_t* row) const {
        while (x0 < x1) {
            const Voxel* from = voxel_address(kernel_.volume, x0, y, z);
            const int in_brick = x0 >= kernel_.volume.last_x ? x1 - x0 : brick_edge - (x0 & (brick_edge - 1));
            const int count = std::min(x1 - x0, in_brick);
            copy_piece(from, count, row + x0);
            x0 += count;
        }
    }

    /// Four at a time: stores of single numbers would wait for memory, each.
    void copy_piece(const Voxel* from, int count, std::uint16_t* to) const {
        const auto opacity = [&, of_stored = of_stored_.data()](int i) {
            if constexpr (sizeof(Voxel) <= 2) return of_stored[from[i]];
            return kernel_.of_stored(from[i]);
        };
        int i = 0;
        for (; i + 4 <= count; i += 4) {
            const std::uint64_t four = opacity(i) | std::uint64_t(opacity(i + 1)) << 16 |
                                       std::uint64_t(opacity(i + 2)) << 32 | std::uint64_t(opacity(i + 3)) << 48;
            std::memcpy(to + i, &four, sizeof four);
        }
        for (; i < count; ++i) to[i] = opacity(i);
    }

    static constexpr int lanes = 16;
    const RowsOf<std::uint16_t> out_;
    const std::vector<std::uint16_t> entries_;
    const kernel::CellOpacityKernel<Voxel> kernel_;
    const kernel::OccupancyView occupancy_;
    const kernel::FindValues<Voxel> find_values_;
    std::vector<std::uint16_t> of_stored_;  ///< opacities by stored value
    std::vector<float> along_x_;            ///< of cells between voxels: where they lie, and in which cell of occupancy
    std::vector<int> occupied_x_;
};

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
