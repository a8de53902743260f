// What the generators share: one row per sample, and the loop over the voxels.
#pragma once
#include <chiaro/samples.h>

#include <algorithm>
#include <cstdint>

#include "core/threads.h"

namespace chiaro {

struct Sample {
    SampleInfo info;
    Volume (*make)(int size, Progress& progress);
    TransferFunction (*transfer_function)();
};

// The rows of the table in samples.cpp.
Sample cornell_sample();
Sample marschner_lobb_sample();
Sample shells_sample();
Sample fog_sample();
Sample slab_sample();
Sample ball_sample();
Sample halfspace_sample();
Sample tubes_sample();
Sample menger_sample();
Sample torso_sample();

/// A cube of `size` voxels of type T, voxel (i, j, k) = value_at(i, j, k); slices in parallel. Throws
/// Error{interrupted} when cancelled.
template <class T, class ValueAt>
Volume generate(int size, Progress& progress, const ValueAt& value_at) {
    Volume volume = make_volume({size, size, size}, voxel_type_of<T>());
    const auto voxels = volume.as<T>();
    parallel_for(usable_threads(), size, 1, "sample", progress, [&](std::int64_t first, std::int64_t last) {
        for (auto k = int(first); k < int(last); ++k)
            for (int j = 0; j < size; ++j) {
                T* row = voxels.data() + (std::size_t(k) * size + j) * size;
                for (int i = 0; i < size; ++i) row[i] = T(value_at(i, j, k));
            }
    });
    progress.check();
    return volume;
}

/// Centre of voxel (i, j, k) in the unit cube that the whole voxels fill.
inline Vec3 in_unit_cube(int i, int j, int k, int size) {
    return {(i + 0.5) / size, (j + 0.5) / size, (k + 0.5) / size};
}

/// Coordinate in [-1, 1], the first and the last voxel centre at the ends.
inline double in_signed_range(int i, int size) { return 2.0 * i / (size - 1) - 1; }

/// Share of a voxel that lies inside a surface at signed distance `depth_voxels` (positive inside) from its centre, as
/// if the surface were flat and parallel to the voxel's face. It makes the half-value isosurface smooth; planes along
/// voxel borders stay sharp.
inline double coverage(double depth_voxels) { return std::clamp(depth_voxels + 0.5, 0.0, 1.0); }

}  // namespace chiaro
