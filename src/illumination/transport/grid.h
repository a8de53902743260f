// The medium as light meets it: cubic cells, coarse enough to be swept in a frame.
#pragma once
#include <chiaro/device.h>

#include "illumination/visibility/density.h"

namespace chiaro {

struct LightGrid {
    Density extinction;                        ///< optical depth of a cell's edge
    std::array<std::vector<float>, 3> albedo;  ///< per channel, x fastest
    bool is_surface;                           ///< isosurfaces, which reflect their albedo (Lambert)
    std::vector<std::size_t> skins;            ///< nodes that a surface leaves mostly open (skin.h)
};

/// At most `cells` on the long axis, each for f³ of the smallest voxels, f of 1, 2, 3, 4, 6, 8, 12 ... Extinction from
/// the mean transmittance of columns, geometric mean over the axes (visibility/density.h); albedo the mean of the
/// classified colours, weighted by extinction, each scaled down to `albedo_max` where a channel is above
/// (illumination.md 4). Cost: that of the density, and a look at every voxel, or where f >= 4 at every second one per
/// axis. Throws Error{interrupted}.
LightGrid light_grid(const Medium::Data& medium, int cells, double albedo_max, const Device& device,
                     Progress& progress);

}  // namespace chiaro
