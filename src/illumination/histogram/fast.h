// Histograms of whole blocks of cells at once, in packed bins.
#pragma once
#include <chiaro/device.h>

#include "illumination/histogram/filter_fit.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/source.h"

namespace chiaro {

/// What all blocks have in common.
struct FastShape {
    kernel::FastBlock block{};        ///< without room
    std::vector<std::uint32_t> code;  ///< of each bin, as FastBlock::tile

    FastShape(const Packing& packing, int radius);
};

/// What is in memory at the same time: planes of nodes; planes of cells, rows of each, cells of each.
struct FastWorkspaceSize {
    int depths = 1, planes = 1, rows = 1, cells = 1;
};
/// Gives a block its room; the bytes it takes of `memory`, which may be null to ask for that.
std::size_t carve_workspace(kernel::FastBlock& block, const FastWorkspaceSize& room, std::byte* memory);

/// LH = M0 ± M1 (3/2 + 2 q²) per packed bin, where M0 = Σ w / W over the ball, M1 = n · Σ w ω / W, n = ∇f / |∇f|, q =
/// M1 / M0: exact for densities that do not depend on the direction, or are those of two half balls, and within .08 of
/// those that rise evenly; clamped to 0 and 2 M0. Near cells are counted on their own side.
class FastHistograms : public HistogramSource {
public:
    FastHistograms(const Device& device, const BinnedCells& cells, const Packing& packing, int radius);

    /// Cost: some 400 ns a cell for 64 bins and a radius of 16, as long as most of the block is asked for.
    void find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const override;

private:
    kernel::FastBlock load(const std::array<std::pair<int, int>, 3>& block) const;
    void find_normals(int y, int z, const std::pair<int, int>& x, float* normals) const;

    const kernel::HistogramFunctions kernels_;
    const FastShape shape_;
};

}  // namespace chiaro
