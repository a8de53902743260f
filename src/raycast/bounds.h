// Ray set-up by rasterisation: where the rays of a tile enter and leave the geometry around all that is visible.
#pragma once
#include <array>
#include <vector>

#include "classify/medium.h"
#include "kernel/launch.h"
#include "raycast/ray_bounds.h"

namespace chiaro {

/// One tile's nearest entries and farthest exits, a layer for each ray of a pixel.
struct TileBounds {
    std::vector<float> near_mm, far_mm, exit_mm;  ///< the last: nearest exit; before any entry the eye is inside
    kernel::BoundsView view(kernel::Tile tile) const { return {near_mm.data(), far_mm.data(), tile.x0, tile.y0}; }
};

/// The faces between blocks of 16³ voxels that are occupied and those that do not, seen by a camera.
class BoundingGeometry {
public:
    BoundingGeometry(const Medium::Data& medium, const kernel::CameraView& camera);

    /// Cost: one intersection for each ray of each pixel in the bounds of each face.
    void rasterise(kernel::Tile tile, int rays_per_pixel, TileBounds& bounds) const;

    std::size_t faces() const { return faces_.size(); }

private:
    /// Of the plane where `axis` is `at`, the rectangle [low, high] of the next two axes.
    struct Face {
        int axis;
        float at;
        std::array<float, 2> low, high;
        bool entered;        ///< by rays that meet it from outside
        int x0, y0, x1, y1;  ///< pixels that it may touch
    };

    void add_faces(const Medium::Data& medium);
    void add_face(int axis, bool at_high_side, std::array<int, 3> first, std::array<int, 3> last,
                  const Medium::Data& medium);
    bool find_pixels(Face& face) const;
    void bin();

    kernel::CameraView camera_;
    std::array<std::array<double, 3>, 3> camera_from_voxel_;  ///< rows: right, up, forward, in mm
    std::vector<Face> faces_;
    int tiles_x_, tiles_y_;
    std::vector<std::vector<int>> faces_of_tile_;
};

}  // namespace chiaro
