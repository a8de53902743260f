// A block of cells whose histograms are found by sums over boxes: where its parts lie.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

/// Coarse cells, 2 half + 1 along each axis, and their weight in either filter.
struct FastBox {
    std::int32_t half_x, half_y, half_z;
    float mass, blur;
};
/// Cells that are counted by themselves.
struct NearCells {
    static constexpr int most = 32;
    float x[most], y[most], z[most], weight[most];
    std::int32_t distance[most];  ///< in the tile
    std::int32_t count;
};

/// Coarse cells are 2³ cells. Nodes are the centres of coarse cells, from two before the block to two behind it.
struct FastBlock {
    static constexpr int edge = 32;  ///< cells
    static constexpr int nodes = edge / 2 + 4;
    static constexpr int max_boxes = 15;

    std::int32_t bins;   ///< of a vector, a multiple of 16
    std::int32_t reach;  ///< coarse cells that the tile has around the nodes
    /// Cells of the block and around it, x fastest: packed bin, its share and the next one's in 256ths from bits 0, 8
    /// and 17 on; 0 outside the volume.
    std::uint32_t* tile;
    std::int32_t tile_row, tile_slice;
    std::int32_t fine_first;  ///< the block's first cell along each axis of the tile

    FastBox box[max_boxes];  ///< with the same half_z one after the other
    NearCells near;
    std::int32_t boxes;

    // Room, vectors of `bins` numbers; on a GPU of columns and rows for each plane of nodes:
    std::int32_t *columns, *rows;  ///< (nodes + 2 reach)² and nodes (nodes + 2 reach)
    float *mass, *blur;            ///< nodes³
    // On a GPU for each plane of a slab, of that for each row, of that for each cell:
    float* plane;      ///< 3 nodes²
    float* line;       ///< 4 nodes
    float* near_bins;  ///< near_numbers(bins): two a bin, and room behind the last

    static constexpr int near_numbers(int bins) { return 2 * bins + 16; }
    int tile_size() const { return tile_row * tile_slice; }
};

}  // namespace chiaro::kernel
