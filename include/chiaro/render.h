// The ray caster, and the whole way from a scene to a picture.
//
// A frame is upload -> prepare -> classify -> illuminate -> raycast -> develop: six stages, each needing only the
// results to its left.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/export.h>
#include <chiaro/image.h>
#include <chiaro/lighting.h>
#include <chiaro/medium.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace chiaro {

/// What the transfer function is asked for: the interpolated value; each voxel's, whose colours are then interpolated;
/// or all values that a step passes, as an integral.
enum class Classification { post, pre, preintegrated };

enum class Compositing { front_to_back, back_to_front };

/// Where a ray begins and ends: at the volume's box, or at the geometry around what is visible, rasterised. The samples
/// are the same.
enum class RaySetup { box, raster };

/// Where rays end, of things that hide what of the volume lies behind them.
struct RayEnds {
    int width = 0, height = 0;  ///< pixels: the picture's
    std::vector<float> mm;      ///< by rows from the top, as Frame::depth_mm: along a pixel's rays; infinity: never
};

struct RaySettings {
    double step_voxels = 0.5;  ///< distance of the samples, in units of the smallest voxel size
    Classification classification = Classification::post;  ///< for Mode::dvr
    Compositing compositing = Compositing::front_to_back;  ///< back to front no ray ends early
    int samples_per_pixel = 1;                             ///< rays through a pixel, averaged
    RaySetup ray_setup = RaySetup::box;
    double early_termination = 0.005;     ///< stop a ray at this remaining transmittance; 0: never
    bool skip_empty = true;               ///< jump over cells that the transfer function leaves empty
    std::shared_ptr<const RayEnds> ends;  ///< none: rays end where the volume does. Paths refuse them
    bool operator==(const RaySettings&) const = default;
};

/// The camera settings with the ball that they fit, where `fit` is visible and none was found before; `by_frame`
/// settled. Of one picture the ball is the one with which pixels of an opacity above .1 fill nine tenths of its width
/// or of its height, to a few hundredths; `all_around` the one with which no frame of a turntable has more. Where
/// nothing is visible, and for a perspective eye and target, which leave nothing to find, no ball is set. Clips and
/// thresholds count, zoom does not. Cost: some three pictures of 192 pixels along the longer side without light, whose
/// rays end at an opacity of .06 (a thin thing covers a part of a small pixel); all around some 36.
CHIARO_EXPORT CameraSettings fit_camera(const Device& device, const Medium& medium, const CameraSettings& camera,
                                        const RaySettings& rays, int width, int height, Progress& progress,
                                        bool all_around = false);

/// How sure a path-traced frame is.
struct PathStatistics {
    int samples = 0;            ///< paths a pixel
    double noise = 0;           ///< RMS over pixels and channels of the standard error; 0 after one path
    double relative_noise = 0;  ///< that over the RMS of the frame; infinite for a black one
};

/// What a ray-casting or path-tracing call did.
struct RenderStatistics {
    bool complete = true;       ///< false: cancelled; rows may be missing
    std::uint64_t samples = 0;  ///< at which the volume was read
    PathStatistics paths;       ///< of path tracing
};

/// L = ∫ κ E T dt by compositing associated colours, one for each step, the last step shortened to the exit (Max 1995;
/// CS 247): of the value at its middle, or pre-integrated between those at its ends (Engel et al. 2001) from a table
/// made for each call. The picture does not depend on the number of threads, nor (up to rounding) on the order. Fills
/// `frame`, whose size is the picture's; where `lighting.probe.background` says so, with the probe behind the volume.
/// Of a block (Volume::placement) the frame is the block's part of the picture, for front_to_back; but in Mode::mip,
/// minip, mean and additive, where the call is collective, the whole picture on every rank.
/// Cost: proportional to the samples in occupied cells; pre-integrated 4 to 20 core-ms for the table.
CHIARO_EXPORT RenderStatistics raycast(const Device& device, const Medium& medium, const IlluminationField& field,
                                       const Lighting& lighting, const Camera& camera, const RaySettings& settings,
                                       Frame& frame, Progress& progress);

/// The same; what a GPU made stays there until it is read.
CHIARO_EXPORT RenderStatistics raycast(const Device& device, const Medium& medium, const IlluminationField& field,
                                       const Lighting& lighting, const Camera& camera, const RaySettings& settings,
                                       DeviceFrame& frame, Progress& progress);

/// Numbers of the blocks of one volume in the order in which a camera's rays meet them, to blend their frames by; those
/// that own nothing come last. Throws Error{usage} for blocks that no plane parts. Cost: n log² n of n blocks.
CHIARO_EXPORT std::vector<int> front_to_back(std::span<const Placement> blocks, const Geometry& whole,
                                             const Camera& camera);

/// Fills `frame.depth_mm`: in mm, how far it is from the eye (orthographic: from the plane through it) along the ray
/// through each pixel's centre to where the opacity of what lies before reaches ½, within a step as for constant
/// extinction; infinity where it never does. With Mode::mip and minip the value's place, with mean and additive
/// infinity everywhere. As `raycast` sees it, but for
/// glow, and always front to back; so it holds for paths too. The frame's size is the picture's, its colours stay.
/// False when cancelled. Cost: less than half of `raycast` without light, and nothing where it is not called.
CHIARO_EXPORT bool find_depth(const Device& device, const Medium& medium, const Camera& camera,
                              const RaySettings& settings, Frame& frame, Progress& progress);

/// Receives a frame that a better one follows, and how sure it is.
using FramePreview = std::function<void(const Frame&, const PathStatistics&)>;
/// The same; the frame's pixels are the next one's when it returns.
using DeviceFramePreview = std::function<void(const DeviceFrame&, const PathStatistics&)>;

/// The reference's radiance: the same L as `raycast`, E found by following light's paths (delta tracking), with
/// `settings.scattering.bounces` further scatterings; in Mode::iso light on matte surfaces. Unbiased: more paths bring
/// every pixel nearer to the truth, by 1 / √paths. The light is the probe alone; step, classification and compositing
/// of `rays` do not matter but for the step that finds isosurfaces. Stops at `settings.reference.rays` paths a pixel,
/// or before at its time or error. The frame does not depend on the number of threads or the instruction set, but for
/// what the time allows. `preview` sees the frame after each pass of 1, 1, 2, 4, ... 16 paths a pixel. Throws
/// Error{usage} for modes that are not lit. Cost: about 1 µs a path and scattering on one core; memory: 40 bytes a
/// pixel, 4 a 4³ cell.
CHIARO_EXPORT RenderStatistics trace_paths(const Device& device, const Medium& medium, const Lighting& lighting,
                                           const Camera& camera, const RaySettings& rays,
                                           const IlluminationSettings& settings, Frame& frame, Progress& progress,
                                           const FramePreview& preview = {});

/// The same; what a GPU made stays there until it is read.
CHIARO_EXPORT RenderStatistics trace_paths(const Device& device, const Medium& medium, const Lighting& lighting,
                                           const Camera& camera, const RaySettings& rays,
                                           const IlluminationSettings& settings, DeviceFrame& frame, Progress& progress,
                                           const DeviceFramePreview& preview = {});

/// The mean radiance J over all directions at points.
struct MeanRadiance {
    std::vector<Rgb> mean;               ///< linear; 1 in an empty white probe
    std::vector<double> error;           ///< its standard error at each point, RMS over the channels
    RenderStatistics render_statistics;  ///< paths: over all points
};

/// J by paths that begin at points (index space, voxel centres at integers; they may lie outside) in directions drawn
/// evenly over the sphere; after that they are those of `trace_paths`, light being scattered at most
/// `settings.scattering.bounces` times on its way to a point. Settings, when it stops, and that the answer depends on
/// no number of threads, as there; the probe stands on `orbit_up`. With `reference.start_half_voxels` above 0 the
/// matter around a point does not dim its light. Throws Error{usage} for modes that are not lit. Cost: about 1 µs a
/// path and scattering on one core; memory: 120 bytes a point.
CHIARO_EXPORT MeanRadiance trace_mean_radiance(const Device& device, const Medium& medium, const Lighting& lighting,
                                               Vec3 orbit_up, std::span<const Vec3> points_voxel,
                                               const IlluminationSettings& settings, Progress& progress);

}  // namespace chiaro
