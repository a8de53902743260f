// How far transport is from light's own paths: J at points, and pictures.
#pragma once
#include "illumination/transport/light.h"
#include "transport_ground_truth.h"

namespace chiaro::bench {

/// Of what was found, from a ground truth with noise of its own, which is taken out.
struct MeanRadianceError {
    double relative = 0;  ///< √(Σ (found - ground truth)² / Σ ground truth²) of J; of pictures RMSE / mean
    double bias = 0;      ///< Σ (found - ground truth) / Σ ground truth
    double noise = 0;     ///< what the ground truth is unsure by, in the measure of `relative`
};

MeanRadianceError error_of(const std::vector<Rgb>& found, const MeanRadiance& ground_truth);

/// Of channel c over the `block`² pixels of a block.
double block_mean(const Frame& frame, int block_x, int block_y, int c, int block);
/// Over means of `block`² pixels, of those blocks where something is seen.
MeanRadianceError error_of(const Frame& found, const Frame& ground_truth, const PathStatistics& sureness, int block);

/// J at points between the nodes: trilinear, in matter by the weights of nodes, in the air by what these leave, so that
/// neither takes the other's light.
std::vector<Rgb> light_between(const TransportNodes& nodes, const std::vector<Vec3>& points, bool in_medium);

/// Points, pictures and their ground truths of a subject under a light.
class TransportErrorMetric {
public:
    struct Effort {
        int air = 256, matter = 128, paths = 2048, paths_a_pixel = 64;
    };
    TransportErrorMetric(const ScatteringSubject& subject, ScatteringCase which, const Effort& effort,
                         Progress& progress);

    /// Light on a grid of so many cells, after at most so many iterations (none: until it changes no more); 0: light
    /// that is scattered but once.
    TransportNodes nodes(int grid, std::optional<int> iterations) const;
    MeanRadianceError in_air(const TransportNodes& nodes) const;
    MeanRadianceError in_medium(const TransportNodes& nodes) const;

    /// L = ∫ κ a J T dt by marching through the medium of the paths, 64 steps a smallest voxel edge, J as pictures of
    /// particles look it up: what this light makes of a picture, whatever a ray caster adds. Some CPU seconds.
    Frame image(const TransportNodes& nodes) const;
    MeanRadianceError of_image(const Frame& frame, int block = 4) const;
    const Frame& ground_truth() const { return image_.first; }
    const MeasuredPoints& points() const { return points_; }

private:
    Rgb light_along(const ShownLight& shown, Vec3 eye, Vec3 direction) const;

    const ScatteringSubject& subject_;
    ScatteringCase which_;
    Progress& progress_;
    MeasuredPoints points_;
    MeanRadiance air_, matter_;
    std::pair<Frame, PathStatistics> image_;
};

}  // namespace chiaro::bench
