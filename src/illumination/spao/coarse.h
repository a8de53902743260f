// The coarser grids of the fused sweep: what crosses wider cells (their mean opacity, for products over cubes), and at
// the corners of these cells what their shell and those further out let through, octant by octant.
#pragma once
#include "core/threads.h"
#include "illumination/access.h"
#include "illumination/spao/launch.h"

namespace chiaro {

/// Opacities of a grid's cells, as 65535ths; x fastest.
struct OpacityGrid {
    std::array<int, 3> count;
    const std::uint16_t* cells;
    const std::uint16_t* row(int y, int z) const { return cells + (std::size_t(z) * count[1] + y) * count[0]; }
};

/// Corner i of an axis lies at the low side of cell i; there is one more than cells.
class CoarseGrid {
public:
    using Cells = std::array<int, 3>;
    /// Cells twice as wide as the finest ones.
    CoarseGrid(const CellOpacity& finest, int octants, const Device& device, Progress& progress);
    /// Twice as wide as those of another.
    CoarseGrid(const CoarseGrid& finer, const Device& device, Progress& progress);

    OpacityGrid opacity() const { return {count_, as_shorts(opacity_)}; }
    /// The blocks of corners that blocks of the next finer grid read.
    void need(const BlockMap& finer);
    const BlockMap& needed() const { return needed_; }
    /// Of a block of corners: what they are worth (null when all are worth the same), and where the results go.
    const std::uint16_t* weights(const Cells& first) const;
    kernel::SpaoOutput output(const Cells& first);
    /// What a block of the next finer grid that begins at `first` reads.
    void load(const Cells& first, kernel::CoarseTile& tile) const;

private:
    static const std::uint16_t* as_shorts(const VoxelBuffer& b) {
        return reinterpret_cast<const std::uint16_t*>(b.data());
    }
    static std::uint16_t* as_shorts(VoxelBuffer& b) { return reinterpret_cast<std::uint16_t*>(b.data()); }
    void allocate(const Cells& finer);
    void shrink(const OpacityGrid& finer, const BlockMap* matter, const Device& device, Progress& progress);
    void find_weights(const OpacityGrid& finest, const BlockMap& matter, const Device& device, Progress& progress);
    std::size_t corner(const Cells& at) const {
        return (std::size_t(at[2]) * corners_[1] + at[1]) * corners_[0] + at[0];
    }
    std::size_t corners() const { return std::size_t(corners_[0]) * corners_[1] * corners_[2]; }

    int octants_;
    Cells count_, corners_;  ///< corners in whole blocks
    VoxelBuffer opacity_, open_, weight_;
    BlockMap needed_{{0, 0, 0}};
};

}  // namespace chiaro
