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

struct RaySettings {
    double step_voxels = 0.5;          ///< distance of the samples, in smallest voxel edges
    double early_termination = 0.005;  ///< stop a ray at this remaining transmittance; 0: never
    bool skip_empty = true;            ///< jump over cells that the transfer function leaves empty
    bool operator==(const RaySettings&) const = default;
};

/// What a ray-casting call did.
struct Outcome {
    bool complete = true;       ///< false: cancelled; rows may be missing
    std::uint64_t samples = 0;  ///< at which the volume was read
};

/// L = ∫ κ E T dt by front-to-back compositing of associated colours, midpoint samples, the last step shortened to the
/// exit (Max 1995; CS 247). The picture does not depend on the number of threads.
/// Fills `frame`, whose size is the picture's. Cost: proportional to the samples in occupied cells.
Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress);

}  // namespace chiaro
