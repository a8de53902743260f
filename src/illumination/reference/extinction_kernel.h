// Extinction of cells for the rays that cross them: one item is a row of a block.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/cells/cell_kernel.h"

namespace chiaro::kernel {

/// κ per edge of one cell: classified at its centre or, of isosurfaces, by how much of it lies inside.
template <class Voxel>
struct CellExtinction {
    VolumeView<Voxel> volume;
    CellCentres cells;
    const std::uint16_t* opacity;  ///< of isosurfaces, x fastest; else null
    const float* entries;          ///< by opacity, or over the stored values
    float scale, offset, last;     ///< index = stored * scale + offset
    std::int32_t count[3];
    float edge_mm;

    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (opacity) return entries[opacity[(std::int64_t(z) * count[1] + y) * count[0] + x]];
        if (cells.is_clipped(x, y, z)) return 0;
        if (volume.is_mixed()) return matter_of_cell(volume, cells, x, y, z).a * edge_mm;
        const Vec3<float> p = volume.clamp(cells.of(x, y, z));
        const float index = volume.value(volume.locate(p, volume.voxel(p))) * scale + offset + 0.5f;
        return entries[std::uint32_t(min(max(index, 0.0f), last))] * factor_of_cell(volume, cells, x, y, z);
    }
};

/// That of nodes, which have it.
struct NodeExtinction {
    const float* density;
    std::int32_t count[3];

    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return density[(std::int64_t(z) * count[1] + y) * count[0] + x];
    }
};

/// Rows of cells of which those `stride` apart are neighbours.
struct ExtinctionLayout {
    std::int32_t stride, phase;  ///< cells from one to the next along x in memory
    std::int32_t row, slice;

    /// Where a cell lies in its row; x may be outside.
    CHIARO_INLINE std::int32_t place(std::int32_t x) const {
        const std::int32_t turn = x >= 0 ? x / stride : -((stride - 1 - x) / stride);
        return (x - turn * stride) * phase + turn;
    }
};

/// Which cells of a row stop light: from the first, less than the end; end 0: none.
struct RowSpan {
    std::uint8_t first, end;
};

template <class Extinction>
struct ExtinctionRow {
    Extinction extinction;
    ExtinctionLayout layout;
    std::int32_t count[3];  ///< cells
    float* out;

    /// Of the row of a block that begins at the cell.
    CHIARO_INLINE RowSpan operator()(std::int32_t first_x, std::int32_t y, std::int32_t z) const {
        std::int32_t first = BlockPlace::edge, end = 0;
        float* row = out + std::int64_t(z) * layout.slice + std::int64_t(y) * layout.row;
        for (std::int32_t i = 0; i < min(BlockPlace::edge, count[0] - first_x); ++i) {
            const float kappa = extinction(first_x + i, y, z);
            row[layout.place(first_x + i)] = kappa;
            if (!(kappa > 0)) continue;
            first = min(first, i), end = i + 1;
        }
        return {std::uint8_t(first), std::uint8_t(end)};
    }
};

/// The same for many threads, a row each of blocks side by side.
template <class Extinction>
struct FillExtinction {
    static constexpr std::int32_t rows = BlockPlace::edge * BlockPlace::edge;  ///< of a block

    ExtinctionRow<Extinction> row;
    const BlockPlace* places;
    RowSpan* spans;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, rows);
        const BlockPlace& place = places[its.block];
        const std::int32_t y = place.first[1] + its.i % BlockPlace::edge, z = place.first[2] + its.i / BlockPlace::edge;
        spans[item] = y < row.count[1] && z < row.count[2] ? row(place.first[0], y, z) : RowSpan{BlockPlace::edge, 0};
    }
};

}  // namespace chiaro::kernel
