// A frame that paths are added to, one for each pixel at a time.
#pragma once
#include <chiaro/render.h>

#include <functional>
#include <optional>
#include <vector>

#include "classify/medium.h"
#include "pathtrace/kernel.h"
#include "pathtrace/light_table.h"
#include "pathtrace/majorants.h"
#include "pathtrace/pixel_sum.h"

namespace chiaro {

struct PathOptions {
    std::optional<int> bounces;  ///< scatterings beyond the first; none: any number
    double albedo_max = 0.9;
    double anisotropy = 0;
    double start_half_edges = 1;
    std::uint64_t seed = 0;
    bool plain = false;  ///< one majorant for the whole volume
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

    void show(Frame& frame) const;  ///< the mean; of the frame's size
    PathStatistics statistics() const;
    std::uint64_t collisions() const { return collisions_; }  ///< tentative ones too
    const std::vector<PixelSum>& sums() const { return sums_; }

private:
    using TraceTile = std::function<std::int64_t(const kernel::PathTask&)>;
    using TraceOnCard = std::function<void(int first, int end, const Progress&)>;
    template <class Matter>
    TraceTile tracer_of(const Matter& matter, const Camera& camera, const RaySettings& settings,
                        const PathOptions& options);
    template <class Voxel>
    TraceTile tracer_through(const Camera& camera, const Lighting& lighting, const RaySettings& settings,
                             const PathOptions& options);
    template <class Kernel>
    TraceOnCard card_tracer_of(const Kernel& kernel);
    void make_colours(const PathOptions& options);
    void add_here(int samples, const Progress& progress);
    std::int64_t trace(const kernel::Tile& tile, int first, int end, const Progress& progress);

    const Device device_;
    const Medium medium_;
    const Lighting lighting_;
    const LightTable light_;
    const Majorants majorants_;
    std::vector<float> extinction_, red_, green_, blue_;
    const int width_, height_;
    const PathPoints points_;
    TraceTile trace_tile_;
    TraceOnCard trace_on_card_;  ///< none: the processor does it
    int samples_ = 0;
    std::uint64_t collisions_ = 0;
    std::vector<PixelSum> sums_;
};

}  // namespace chiaro
