// Lighting methods beside the truth.
#pragma once
#include <chiaro/compare.h>
#include <chiaro/session.h>

#include <vector>

namespace chiaro {

/// A method's picture of a scene, and how far it is from the reference's.
struct MethodPicture {
    Method method;
    Frame frame;               ///< linear light, over black
    double light_seconds;      ///< to prepare the volume and find the light; of the reference 0
    double frame_seconds;      ///< another picture by that light
    std::size_t light_bytes;   ///< held: what was prepared, and the light
    ImageDifference distance;  ///< from the reference, of linear light; of the reference itself 0
};

struct MethodComparison {
    std::vector<MethodPicture> pictures;  ///< in the order asked for
    MethodPicture reference;
    double noise = 0;  ///< standard error of the reference, RMS over pixels and channels
    int paths = 0;     ///< of a pixel of the reference
};

/// Renders the scene of the session's volume by each method under the same light: the scene's probe (white without
/// one), all matter particles that scatter it alike in all directions, once (illumination.md 4: L = ∫ κ E T dt). So
/// shading is off, steps are pre-integrated; spao, and rays that find accessibility, give E = A × the probe's mean
/// radiance, A neither scaled nor moved off surfaces; visibility gives E = (1/4π) Σ V L. The reference is the path
/// tracer with 0 bounces and the paths that `scene.illumination.reference` asks for. Throws
/// Error{usage} but for Mode::dvr, else as Session::render.
MethodComparison compare_methods(Session& session, const Scene& scene, const std::vector<Method>& methods,
                                 Progress& progress);

}  // namespace chiaro
