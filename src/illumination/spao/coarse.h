// The coarser grids of the fused sweep: what crosses wider cells (their mean opacity, for products over cubes), and at
// the corners of these cells what their shell and those further out let through, octant by octant.
#pragma once
#include "core/threads.h"
#include "illumination/access.h"
#include "illumination/spao/launch.h"

namespace chiaro {

inline kernel::OpacityGrid opacity_grid(const std::array<int, 3>& count, const std::uint16_t* cells) {
    return {{count[0], count[1], count[2]}, cells};
}

/// How many cells and corners there are in a grid of cells twice as wide. Corner i of an axis lies at the low side of
/// cell i; there is one more than cells, and then whole blocks of them (which a GPU holds).
struct CoarseShape {
    std::array<int, 3> count{0, 0, 0}, corners{0, 0, 0};

    CoarseShape() = default;
    explicit CoarseShape(const std::array<int, 3>& finer);
    std::size_t cells_held() const { return std::size_t(count[0]) * count[1] * count[2]; }
    std::size_t corners_held() const { return std::size_t(corners[0]) * corners[1] * corners[2]; }
    /// The blocks of corners, and pieces of them, that those of the next finer grid read.
    BlockMap needed_by(const BlockMap& finer) const;

private:
    void need_piece(BlockMap& needed, const std::array<int, 3>& first) const;
};

class CoarseGrid {
public:
    using Cells = std::array<int, 3>;
    /// Cells twice as wide as `finer` ones, of which nothing is known yet.
    CoarseGrid(const Cells& finer, int octants);
    /// Cells twice as wide as the finest ones.
    CoarseGrid(const CellOpacity& finest, int octants, const Device& device, Progress& progress);
    /// Twice as wide as those of another.
    CoarseGrid(const CoarseGrid& finer, const Device& device, Progress& progress);

    const CoarseShape& shape() const { return shape_; }
    const Cells& corners() const { return corners_; }
    CellRows cells() const { return rows_of(shape_.count, as_shorts(opacity_)); }
    /// Finds slices [first, end) of its cells. `matter` tells which blocks of the finer grid may hold something else
    /// than 0; null: all may.
    void shrink(const CellRows& finer, const BlockMap* matter, const Device& device, int first, int end);
    /// Finds the weights of slices [first, end) of corners, `stride` corners of the first coarse grid apart, where
    /// corners have weights.
    void find_weights(const CellRows& finest, const BlockMap& matter, int stride, const Device& device, int first,
                      int end);
    /// From now on only so many slices of corners are held.
    void hold(int first_slice, int slices);
    void free_cells() { opacity_ = VoxelBuffer(); }
    /// Where few blocks hold matter.
    void use_small_pages() { opacity_.use_small_pages(), open_.use_small_pages(), small_pages_ = true; }
    /// To be written.
    std::uint16_t* written_cells() { return as_shorts(opacity_); }
    std::uint16_t* corner_weights() { return as_shorts(weight_); }
    /// What is not read any more.
    void discard_cells_before(int slice);
    void discard_corners_before(int slice);
    /// From now on corners are found where blocks of the next finer grid read them.
    void need(const BlockMap& finer) { needed_ = shape_.needed_by(finer); }
    const BlockMap& needed() const { return needed_; }
    /// Tells a block of corners what they are worth (nothing where all are worth the same).
    void weigh(const Cells& first, kernel::SpaoBlock& block) const;
    /// Where the results of slices of a block of corners go; `pieces` must stay where they are.
    kernel::SpaoOutput output(const Cells& first, int slices, const BlockPieces& pieces);
    /// What a block of the next finer grid that begins at `first` reads.
    kernel::CoarseRows rows_for(const Cells& first) const;

private:
    static const std::uint16_t* as_shorts(const VoxelBuffer& b) {
        return reinterpret_cast<const std::uint16_t*>(b.data());
    }
    static std::uint16_t* as_shorts(VoxelBuffer& b) { return reinterpret_cast<std::uint16_t*>(b.data()); }
    void weigh_row(const CellRows& finest, const BlockMap& matter, const Device& device, int y, int z,
                   std::vector<std::uint16_t>& to) const;
    std::size_t corner(const Cells& at) const {
        return (std::size_t(at[2] - first_slice_) * corners_[1] + at[1]) * corners_[0] + at[0];
    }
    /// Of one octant; the rows of all lie next to each other.
    std::size_t open_row() const { return std::size_t(octants_) * corners_[0]; }
    std::size_t open_corner(const Cells& at) const {
        return (std::size_t(at[2] - first_slice_) * corners_[1] + at[1]) * open_row() + at[0];
    }

    int octants_;
    CoarseShape shape_;
    Cells corners_{0, 0, 0};            ///< held: one more than cells
    int first_slice_ = 0, slices_ = 0;  ///< of corners, held
    VoxelBuffer opacity_, weight_;
    VoxelBuffer open_;  ///< [z][y][octant][x]
    bool small_pages_ = false;
    BlockMap needed_{{0, 0, 0}};
};

}  // namespace chiaro
