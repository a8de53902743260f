// A frame that paths are added to, one for each pixel at a time.
#pragma once
#include <chiaro/render.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "classify/medium.h"
#include "classify/surface_table.h"
#include "illumination/floor/floor.h"
#include "pathtrace/gpu.h"
#include "pathtrace/light_table.h"
#include "pathtrace/majorants.h"
#include "pathtrace/reflection_table.h"
#include "raycast/render_target.h"

namespace chiaro {

struct PathOptions {
    std::optional<int> bounces;  ///< scatterings beyond the first; none: any number
    double albedo_max = 0.9;
    double anisotropy = 0;
    double start_half_voxels = 1;
    std::uint64_t seed = 0;
    bool surfaces = false;  ///< matter whose opacity rises steeply is a surface; else all are particles
    bool plain = false;     ///< one majorant for the whole volume
};
PathOptions path_options(const IlluminationSettings& settings);

/// A point for each pixel of a frame, row by row, where its paths begin in the place of a camera; voxels.
struct PathPoints {
    std::vector<float> x, y, z;
};

class PathTracer {
public:
    /// Throws Error{usage} for maxima along rays.
    PathTracer(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
               const RaySettings& settings, const PathOptions& options, int width, int height, PathPoints points = {});

    PathTracer(const PathTracer&) = delete;  // the kernel points into it
    PathTracer& operator=(const PathTracer&) = delete;

    /// Adds so many paths to every pixel; false when cancelled, and then the sums are of no use.
    bool add(int samples, const Progress& progress);

    void show(RenderTarget& target);  ///< the mean, on the GPU that has made it; of the frame's size
    PathStatistics statistics();
    std::uint64_t collisions() const { return gpu_ ? gpu_->collisions() : collisions_; }  ///< tentative ones too
    const std::vector<PixelSum>& sums();

private:
    using TraceTile = std::function<std::int64_t(const kernel::PathTask&)>;
    template <class Matter>
    TraceTile tracer_of(const Matter& matter, const Camera& camera, const RaySettings& settings,
                        const PathOptions& options);
    template <class Voxel>
    TraceTile tracer_through(const Camera& camera, const Lighting& lighting, const RaySettings& settings,
                             const PathOptions& options);
    template <class Kernel>
    std::unique_ptr<GpuPaths> gpu_tracer_of(const Kernel& kernel) const;
    template <class Work>
    bool done_there(const Work& work);
    void make_colours(const PathOptions& options);
    void add_here(int end, const Progress& progress);
    std::int64_t trace(const kernel::Tile& tile, int first, int end, const Progress& progress);

    const Device device_;
    const Medium medium_;
    const Lighting lighting_;
    const LightTable light_;
    const std::optional<Floor> floor_;
    const std::shared_ptr<const SurfaceTable> surface_table_;
    const ReflectionTable reflection_;
    const Majorants majorants_;
    int floor_material_ = 0;
    std::vector<float> extinction_, red_, green_, blue_;
    const int width_, height_;
    const PathPoints points_;
    TraceTile trace_tile_;
    int samples_ = 0;
    std::unique_ptr<GpuPaths> gpu_;  ///< it has the sums; none: they are here
    std::uint64_t collisions_ = 0;
    std::vector<PixelSum> sums_;
};

}  // namespace chiaro
