// The device layout of voxels: bricks of 32³ voxels, each stored with the neighbours that interpolation and gradients
// inside it touch: one voxel before, two behind. So a sample's voxels lie at fixed distances from one address, on every
// axis.
#pragma once
#include <cstdint>

namespace chiaro {

inline constexpr int brick_bits = 5;
inline constexpr int brick_edge = 1 << brick_bits;        ///< voxels a brick answers for, per axis
inline constexpr int brick_before = 1, brick_behind = 2;  ///< border voxels kept with it
inline constexpr int brick_row = brick_edge + brick_before + brick_behind;
inline constexpr int brick_slice = brick_row * brick_row;
inline constexpr int brick_voxels = brick_slice * brick_row;
inline constexpr int cell_bits = 2;  ///< occupancy is kept for cells of 4³ voxel intervals
inline constexpr int cell_edge = 1 << cell_bits;

/// Bricks along an axis of n voxels: they cover its n - 1 intervals.
constexpr int brick_count(int n) { return n <= 2 ? 1 : (n - 2) / brick_edge + 1; }
constexpr int cell_count(int n) { return n <= 2 ? 1 : (n - 2) / cell_edge + 1; }

}  // namespace chiaro
