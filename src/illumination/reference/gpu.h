// The reference's rays on a GPU: the medium goes there once, and what a direction's rays need when it is their turn.
#pragma once
#include "cuda/device_cache.h"
#include "illumination/reference/launch_gpu.h"

namespace chiaro {

inline void swap_medium(cuda::Views& views, kernel::CellRays& rays) { views.to_device_pointers(rays.extinction); }
inline void swap_way(cuda::Views& views, kernel::CellRays& rays) {
    views.to_device_pointers(rays.crossings, rays.x_axis.beyond, rays.y_axis.beyond, rays.z_axis.beyond);
}
template <class Voxel>
void swap_medium(cuda::Views& views, kernel::InterpolatedRays<Voxel>& rays) {
    swap_pointers(views, rays.volume);
    views.to_device_pointers(rays.extinction);
}
template <class Voxel>
void swap_way(cuda::Views& views, kernel::InterpolatedRays<Voxel>& rays) {
    views.to_device_pointers(rays.planes);
}

/// run(rays, direction) for each of the directions, `follow(direction)` with pointers of the GPU's. `medium`: what
/// follow.add_medium(arrays) tells of. Throws Error{interrupted}.
template <class Follower, class Run>
void follow_on_gpu(cuda::Stream& stream, cuda::Views& medium, Follower& follow, const std::vector<Vec3>& directions,
                   Progress& progress, const Run& run) {
    for (const Vec3& direction : directions) {
        auto rays = follow(direction);
        HostArrays arrays;
        follow.add_way(arrays);
        cuda::Views way(stream, std::move(arrays));  // waits before the next direction takes its place
        swap_medium(medium, rays), swap_way(way, rays);
        run(rays, direction);
        progress.check();
    }
}

}  // namespace chiaro
