// What every volume must satisfy, whichever reader it came from.
#pragma once
#include <chiaro/volume.h>

#include <cstdint>

namespace chiaro {

/// Bytes of all voxels. Throws Error{input} unless every dimension is in 1..65535 and components in 1..65535, and the
/// size can be counted in 64 bits. Takes the numbers as a header states them: they may be absurd.
std::uint64_t checked_bytes(const std::array<std::int64_t, 3>& dimensions, std::int64_t components, VoxelType type);

/// Checks everything but the voxels, and returns how many bytes they take. Throws Error{input} for dimensions outside
/// 1..65535, geometry that makes no sense, or a slope that is not finite.
std::uint64_t check_header(const Volume& volume);

/// Throws Error{input} unless all numbers are finite, spacings positive, directions unit vectors and not singular.
void check_geometry(const Geometry& geometry);

/// Throws Error{input} unless the extreme values, after slope and intercept, are finite.
void check_values(const Volume& volume, double min, double max);

/// Sets spacing and direction from the steps (world millimetres) between voxels along each index axis.
/// Throws Error{input} for steps that are not finite, zero, or span no volume.
void set_steps(Geometry& geometry, const std::array<Vec3, 3>& steps_mm);

}  // namespace chiaro
