// What labels make of a medium, on their own grid.
#pragma once
#include <chiaro/labels.h>
#include <chiaro/medium.h>

#include "volume/label_bricks.h"

namespace chiaro {

/// As LabelBricks, but x fastest; and what a voxel has that lies beyond the labels.
struct LabelFields {
    std::array<int, 3> dimensions{0, 0, 0};
    std::array<std::int64_t, 3> tiles{0, 0, 0};  ///< of 32³ voxels, each found for itself
    VoxelBuffer distance, share, tint;
    std::uint8_t distance_beyond = LabelCoding::shown, share_beyond = 255;
    std::uint32_t tint_beyond = 0;
    std::vector<TransferShare> transfers;  ///< beyond the labels all is by the volume's
};

/// Borders are those of sets of labels that look alike (classify/labels/border.h): of all that are shown, of those at
/// least as opaque as each other, of each tint and of each transfer function. A border between two tints, or functions,
/// is half a voxel wide on either side; what is hidden takes its neighbours', so that what is cut free has its own
/// colour. Where more than 16 tints meet within some voxels, tints are means over 3³ voxels. The same for any number of
/// threads. Cost: 1 core-ms for every 32³ voxels near a border and each look there. Throws Error{interrupted} when
/// cancelled. `looks` are the labels' in their order.
LabelFields make_label_fields(const LabelVolume& labels, const std::vector<Label>& looks, ColorMode color, int threads,
                              const Progress& progress);

/// The same after looks have changed, from what they were: bit for bit what make_label_fields gives. Only the tiles
/// that hold such a label, or voxels within reach of one (BorderTile::halo_of), are found anew, unless there are other
/// degrees of opacity or transfer functions than before, or tints where none were. Returns which tiles, a byte each, x
/// fastest. Where it throws, the fields are of no use.
std::vector<std::uint8_t> renew_label_fields(LabelFields& fields, const LabelVolume& labels,
                                             const std::vector<Label>& before, const std::vector<Label>& now,
                                             ColorMode color, int threads, const Progress& progress);

/// Bricks of other looks, which differ in these tiles alone.
struct OlderBricks {
    const LabelBricks& bricks;
    const std::vector<std::uint8_t>& tiles;
};
/// In bricks of a volume of these dimensions. Beyond the labels' grid nothing is labelled. `older`: its bricks that no
/// such tile reaches are copied.
LabelBricks in_bricks(const LabelFields& fields, const LabelPlacement& placement, const std::array<int, 3>& dimensions,
                      int threads, const Progress& progress, const OlderBricks* older = nullptr);

}  // namespace chiaro
