// How much memory things need, said before they are begun: nothing warns of memory that runs out later.
#pragma once
#include <chiaro/error.h>
#include <chiaro/scene.h>

#include <cstdint>
#include <optional>

namespace chiaro::server {

/// What the page is told by the code `memory`.
class OutOfMemory : public Error {
public:
    OutOfMemory(double needed, double free);  ///< bytes
};

/// Bytes that may still be taken; the environment variable CHIARO_VIEW_MEMORY (MiB) lowers it, for tests.
double free_memory();

/// Throws OutOfMemory for more bytes than are free.
void check_memory(double needed);

/// Bytes that light by these settings holds for so many cells while it is found, at most: where half of the volume is
/// empty it is less.
double light_bytes(const IlluminationSettings& settings, double cells);

/// Bytes of the volume's bricks (src/volume/bricks.h): voxels with the border that each brick keeps, 1.31 × the voxels
/// of a large volume. Of numbers wider than 4 bytes at most.
double brick_bytes(const Volume& volume);

/// Means of 2³ voxels (along an axis of one voxel, of one); at odd ends, of what there is. Where a mean would need
/// numbers that the type has not, it is rounded. Cost: one pass.
Volume halved(const Volume& volume);

/// Halves a volume until its bricks, as many of a spline's coefficients and the light of the default method fit too, at
/// least `least` times; what was done is its first and last size.
struct Fitted {
    std::array<int, 3> from, to;
    double free;  ///< bytes
    bool is_reduced() const { return from != to; }
};
Fitted fit(Volume& volume, int least);

}  // namespace chiaro::server
