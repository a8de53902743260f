// The largest piece of what a medium shows, and a volume that holds nothing else.
#pragma once
#include <optional>
#include <utility>

#include "classify/medium.h"

namespace chiaro {

/// Pieces of a volume: sets of voxels that are connected through faces.
struct Pieces {
    std::size_t count = 0;
    std::size_t largest = 0, second = 0;      ///< voxels
    std::vector<std::uint8_t> is_of_largest;  ///< a byte a voxel, x fastest
};

/// Of the voxels whose byte is `least` and more. Of pieces of the same size the first counts as larger. Cost: one pass,
/// a number for each run of voxels in a row.
Pieces find_pieces(const std::vector<std::uint8_t>& voxels, std::array<int, 3> dimensions, std::uint8_t least = 1);

/// Those of the stored values from `of.first` to `of.second` that lie outside all isosurfaces from data value `lowest`
/// on; none where all lie within.
std::optional<std::pair<float, float>> values_outside(const DeviceVolume::Data& volume, double lowest,
                                                      std::pair<float, float> of);

/// The volume of which only the largest piece is visible: voxels of an opacity of .1 and more over the opacity's unit
/// (Mode::iso: at or above the lowest surface's value) whose centres the clip keeps, and what is fainter within two
/// voxels of it. All others but those beside it get values that show nothing, and between which nothing is seen either:
/// of the range of such values that most voxels near the piece have (Mode::mean and minip: only those that showed
/// something). A spline would swing beyond these, so farther off its
/// coefficients are bounded. Throws Error{usage} where no value shows nothing. Cost: a copy of the bricks, a byte a
/// voxel, and four more while it is made; some 15 core-ns a voxel.
DeviceVolume with_largest_piece(const Medium::Data& medium);

}  // namespace chiaro
