// Opacity by gradient, and transfer functions over value and gradient: what they leave of the extinction.
#pragma once
#include <chiaro/transfer_function.h>

#include "classify/medium.h"

namespace chiaro {

/// The table of a function over the volume's stored values and the magnitudes that it tells apart; null where it leaves
/// everything as it is. `color`: how its colours are composited.
std::shared_ptr<const ExtinctionFactor> make_factor(const DeviceVolume::Data& volume, const TransferFunction& tf,
                                                    ColorMode color);

/// The volume with a factor (null: without): the same voxels, borrowed.
DeviceVolume with_factor(const DeviceVolume& volume, std::shared_ptr<const ExtinctionFactor> factor);

/// For each cell whether the volume's factor may leave anything in it: 0 or 1. Gradients are told by the cells' ranges:
/// the differences of two voxels of a cell and its neighbours over two spacings are at most as far apart as those.
std::vector<std::uint8_t> cells_with_factor(const DeviceVolume::Data& volume);

}  // namespace chiaro
