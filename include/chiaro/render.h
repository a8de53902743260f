// The ray caster, and the whole way from a scene to a picture.
//
// A frame is upload -> prepare -> classify -> illuminate -> raycast -> develop: six verbs, each needing only the
// results to its left.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/image.h>
#include <chiaro/lighting.h>
#include <chiaro/medium.h>

#include <cstdint>

namespace chiaro {

/// What the transfer function is asked for: the interpolated value; each voxel's, whose colours are then interpolated;
/// or all values that a step passes, as an integral.
enum class Classification { post, pre, preintegrated };

enum class Compositing { front_to_back, back_to_front };

/// Where a ray begins and ends: at the volume's box, or at the geometry around what is visible, rasterised. The samples
/// are the same.
enum class RaySetup { box, raster };

struct RaySettings {
    double step_voxels = 0.5;                              ///< distance of the samples, in smallest voxel edges
    Classification classification = Classification::post;  ///< for Mode::dvr
    Compositing compositing = Compositing::front_to_back;  ///< back to front no ray ends early
    int samples_per_pixel = 1;                             ///< rays through a pixel, averaged
    RaySetup ray_setup = RaySetup::box;
    double early_termination = 0.005;  ///< stop a ray at this remaining transmittance; 0: never
    bool skip_empty = true;            ///< jump over cells that the transfer function leaves empty
    bool operator==(const RaySettings&) const = default;
};

/// What a ray-casting call did.
struct Outcome {
    bool complete = true;       ///< false: cancelled; rows may be missing
    std::uint64_t samples = 0;  ///< at which the volume was read
};

/// L = ∫ κ E T dt by compositing associated colours, one for each step, the last step shortened to the exit (Max 1995;
/// CS 247): of the value at its middle, or pre-integrated between those at its ends (Engel et al. 2001) from a table
/// made for each call. The picture does not depend on the number of threads, nor (up to rounding) on the order. Fills
/// `frame`, whose size is the picture's; where `lighting.probe.background` says so, with the probe behind the volume.
/// Cost: proportional to the samples in occupied cells; pre-integrated 4 to 20 core-ms for the table.
Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress);

}  // namespace chiaro
