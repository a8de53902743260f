// What the generators share: one row per sample, and the loop over the voxels.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/samples.h>

#include <algorithm>
#include <cstdint>
#include <functional>

namespace chiaro {

/// Voxels of any box of a sample.
struct SampleVoxels {
    VoxelType type;
    std::function<void(const VoxelBox& box, std::byte* to)> fill;  ///< x fastest; from any thread
};

struct Sample {
    SampleInfo info;
    SampleVoxels (*voxels)(int size);
    TransferFunction (*transfer_function)();
    void (*place)(Volume& volume) = nullptr;  ///< in the world, where it is not one voxel a millimetre
};
/// Throws Error{usage} for an unknown name (with "did you mean").
Sample sample_named(const std::string& name);
/// The sample's header, without voxels. Throws Error{usage} for a size outside 2..`most`.
Volume sample_header(const Sample& sample, int size, int most);

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
Sample organs_sample();

/// Voxels of type T, voxel (i, j, k) = value_at(i, j, k).
template <class T, class ValueAt>
SampleVoxels generate(const ValueAt& value_at) {
    const auto fill = [value_at](const VoxelBox& box, std::byte* to) {
        T* voxel = reinterpret_cast<T*>(to);
        const auto [x, y, z] = box.first;
        const auto [nx, ny, nz] = box.size;
        for (int k = z; k < z + nz; ++k)
            for (int j = y; j < y + ny; ++j, voxel += nx)
                for (int i = 0; i < nx; ++i) voxel[i] = T(value_at(x + i, j, k));
    };
    return {voxel_type_of<T>(), fill};
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
