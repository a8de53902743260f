// Opacities of rows of cells, by the processor.
#pragma once
#include <cstring>
#include <limits>

#include "classify/medium.h"
#include "illumination/cells/launch_rows.h"
#include "illumination/cells/opacity.h"
#include "volume/device_view.h"
#include "volume/float3.h"
#include "volume/occupancy.h"

namespace chiaro {

/// Opacities by entry of the optical table; none of isosurfaces.
inline std::vector<std::uint16_t> opacity_entries(const Medium::Data& medium, const CellGrid& grid) {
    std::vector<std::uint16_t> entries;
    if (medium.shape.mode == Mode::iso) return entries;
    for (float kappa : extinction_per_edge(medium, grid)) entries.push_back(cell_value(-std::expm1(-kappa)));
    return entries;
}

inline kernel::CoverageView coverage_view(const Medium::Data& medium, const CellGrid& grid) {
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
          run_(kernel::cell_functions_for(medium.volume.data().device.isa)),
          ranges_(medium.volume.data().cells),
          gradient_reach_(medium.volume.data().normal_reach[0] > 0 ? 2 : 1) {
        if (!entries_.empty() && sizeof(Voxel) <= 2)
            for (std::size_t v = 0; v < std::size_t(1) << (8 * sizeof(Voxel)); ++v)
                of_stored_.push_back(kernel_.of_stored(float(v)));
        for (int x = 0; x < grid.count[0] + lanes; ++x) {
            along_x_.push_back(float(kernel_.cells.along(0, x)));
            occupied_x_.push_back(kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(x, 0, 0))).x >> cell_bits);
        }
    }

    /// Cells [x0, x1) of a row.
    void fill(int x0, int x1, int y, int z, bool near_surface) {
        std::uint16_t* row = out_.row(y, z);
        if (!kernel_.entries && (kernel_.labels.distance || kernel_.volume.is_mixed()))
            for (int x = x0; x < x1; ++x) row[x] = kernel_.inside(x, y, z, near_surface);
        else if (!kernel_.entries)
            for (int x = x0; x < x1; x += lanes) fill_inside(x, std::min(x + lanes, x1), y, z, near_surface, row);
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

    kernel::ValueRow points(int x0, int y, int z, float* to) const {
        return {&along_x_[std::size_t(x0)], float(kernel_.cells.along(1, y)), float(kernel_.cells.along(2, z)), lanes,
                to};
    }

    /// By what is seen of some cells side by side, whose values are found together.
    void fill_between_voxels(int x0, int x1, int y, int z, std::uint16_t* row) const {
        const auto first = kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(0, y, z)));
        const std::uint8_t* occupied = occupancy_.cells + occupancy_.index<float>({0, first.y, first.z});
        std::uint8_t seen[lanes], any = 0;
        for (int i = 0; i < lanes; ++i) any |= seen[i] = occupied[occupied_x_[std::size_t(x0 + i)]] & 1;
        if (!any) return void(std::fill(row + x0, row + x1, std::uint16_t(0)));
        float values[lanes];
        run_.find_values(kernel_.volume, points(x0, y, z, values));
        std::int32_t entry[lanes];
        for (int i = 0; i < lanes; ++i) entry[i] = kernel_.entry_of(values[i]);
        for (int x = x0; x < x1; ++x) row[x] = seen[x - x0] ? entries_[std::size_t(entry[x - x0])] : 0;
    }

    /// By how much of some cells side by side lies inside surfaces. Far from these one value says it for all.
    void fill_inside(int x0, int x1, int y, int z, bool near_surface, std::uint16_t* row) const {
        const auto [low, high] = range_around(x0, x1, y, z, near_surface ? gradient_reach_ : 0);
        if (kernel_.surfaces.is_passed_by(low, high, near_surface)) {
            const float share = kernel_.surfaces.template opacity<float>(low, 0, 1);
            return void(std::fill(row + x0, row + x1, kernel::share_value(share)));
        }
        float shares[lanes];
        run_.find_inside(kernel_, points(x0, y, z, shares), near_surface);
        for (int x = x0; x < x1; ++x) row[x] = kernel::share_value(shares[x - x0]);
    }
    /// Of what lies in the cells of occupancy that some cells side by side are in, and so many further.
    std::pair<float, float> range_around(int x0, int x1, int y, int z, int further) const {
        const auto at = kernel_.volume.voxel(kernel_.volume.clamp(kernel_.cells.of(0, y, z)));
        const auto around = [&](int axis, int first, int last) {
            return std::pair(std::max(first - further, 0), std::min(last + further, ranges_.count[axis] - 1));
        };
        const auto [first_x, last_x] = around(0, occupied_x_[std::size_t(x0)], occupied_x_[std::size_t(x1 - 1)]);
        const auto [first_y, last_y] = around(1, at.y >> cell_bits, at.y >> cell_bits);
        const auto [first_z, last_z] = around(2, at.z >> cell_bits, at.z >> cell_bits);
        std::pair range(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
        for (int k = first_z; k <= last_z; ++k)
            for (int j = first_y; j <= last_y; ++j) {
                const std::size_t row = (std::size_t(k) * ranges_.count[1] + j) * ranges_.count[0];
                for (int i = first_x; i <= last_x; ++i) {
                    range.first = std::min(range.first, ranges_.low[row + i]);
                    range.second = std::max(range.second, ranges_.high[row + i]);
                }
            }
        return range;
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
    const kernel::RowFunctions<Voxel> run_;
    const CellRanges& ranges_;
    const int gradient_reach_;  ///< in cells of occupancy: two voxels, or five of thick slices (volume/view.h)
    std::vector<std::uint16_t> of_stored_;  ///< opacities by stored value
    std::vector<float> along_x_;            ///< where cells lie among the voxels
    std::vector<int> occupied_x_;           ///< and in which cell of occupancy
};

}  // namespace chiaro
