// Directions of one sweep of scattered light, others each time.
#pragma once
#include <chiaro/geometry.h>

#include <cstdint>
#include <vector>

namespace chiaro {

/// `count` directions evenly over the sphere, turned. 24 are the improved snub cube (McLaren 1963), whose mean of any
/// polynomial up to degree 7 is that over the sphere; others a Fibonacci set. Turns fill the group of rotations ever
/// more evenly with `index` (R3, Roberts 2018; as quaternions, Shoemake 1992); `seed` moves their sequence.
std::vector<Vec3> turned_directions(int count, int index, std::uint64_t seed);

}  // namespace chiaro
