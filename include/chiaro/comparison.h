// Lighting methods compared with the ground truth.
#pragma once
#include <chiaro/compare.h>
#include <chiaro/export.h>
#include <chiaro/session.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace chiaro {

/// A method's picture of a scene, and how far it is from the reference's.
struct MethodImage {
    Method method;
    Frame frame;               ///< linear light, over black
    double light_seconds;      ///< to prepare the volume and find the light; of the reference 0
    double frame_seconds;      ///< another picture by that light
    std::size_t light_bytes;   ///< held: what was prepared, and the light
    ImageDifference distance;  ///< from its reference, of linear light; of a reference itself 0
    /// RMSE of means over 8 × 8 pixels, where at least half of them is covered, over the mean of the reference there.
    /// The reference's own noise is in it, an eighth of a pixel's.
    double block_error;
    std::size_t reference;  ///< which of the comparison's
};

/// A ground truth, and the light that it is of.
struct MethodReference {
    MethodImage image;
    std::string light;  ///< "scattered once", ...
    double noise = 0;   ///< standard error, RMS over pixels and channels
    int paths = 0;      ///< of a pixel
};

struct MethodComparison {
    std::vector<MethodImage> images;          ///< in the order asked for
    std::vector<MethodReference> references;  ///< one for particles; for surfaces one for each kind of light
};

/// Receives a comparison with the paths so far.
using ComparisonPreview = std::function<void(const MethodComparison&)>;

/// Renders the scene of the session's volume by each method and by the reference, the path tracer, with the paths that
/// `scene.illumination.reference` asks for.
///
/// As shown, unless the scene's `surfaces` are none: transport against the reference of the scene's bounces, visibility
/// against light that is scattered once, under the scene's probe (white without one) and shading. Methods that take no
/// probe (none, spao, histogram) are judged by the occlusion they find: they and their reference are drawn under a
/// white probe, light scattered once, at strength 1, without headlight and highlights.
///
/// Of particles (`surfaces` none): by the same light for all, the scene's probe, all matter particles (isotropic volume
/// scattering, no surfaces), once (L = ∫ κ E T dt, docs/methods.md). So shading is off, steps are pre-integrated; spao,
/// and rays that find accessibility, give E = A × the probe's mean radiance, A neither scaled nor read at a normal
/// offset; visibility gives E = (1/4π) Σ V L.
///
/// `preview` sees it with each pass of paths, 1, 1, 2, 4, ... 16 a pixel; of references that are not begun yet there
/// are none. Throws Error{usage} but for Mode::dvr, else as Session::render.
CHIARO_EXPORT MethodComparison compare_methods(Session& session, const Scene& scene, const std::vector<Method>& methods,
                                               Progress& progress, const ComparisonPreview& preview = {});

/// How far a method's light is from the ground truth where matter is seen. All but `points` are fractions of the mean
/// light.
struct LightError {
    int points = 0;                        ///< at which something is seen
    double rmse = 0;                       ///< over points and channels
    std::array<double, 2> interval{0, 0};  ///< of the RMSE, 95 %: as far as so many points and paths can tell
    double largest = 0;                    ///< RMS over the channels of one point
};

/// RMSE of the light that arrives, by the scene's method, at so many points of the session's volume, against the
/// reference's (`trace_mean_radiance`), whose noise is taken off: 1024 paths from each, scattered as often as the
/// method follows light. The points lie two voxel widths before what contributes most to pixels that are drawn at
/// random, always the same ones: at the boundary of dense matter light ends within a voxel. Light is that on particles,
/// as in `compare_methods`: neither read at a normal offset nor scaled. Throws Error{usage} where no light arrives that
/// could be wrong (none, the path-traced reference, histograms without occlusion, Mode::mip, a picture of nothing),
/// else as Session::render, which it uses: give it a session of its own (`Session::share_volume`). Cost: the method's
/// light once more, if this session has not it yet, and some core-seconds for the paths.
CHIARO_EXPORT LightError measure_light(Session& session, const Scene& scene, Progress& progress, int points = 1024);

}  // namespace chiaro
