// How far transport is from light's own paths: J at points, and pictures.
#pragma once
#include "illumination/transport/light.h"
#include "transport_truth.h"

namespace chiaro::bench {

/// Of what was found, from a truth with noise of its own, which is taken out.
struct FluenceError {
    double relative = 0;  ///< √(Σ (found - truth)² / Σ truth²) of J; of pictures RMSE / mean
    double bias = 0;      ///< Σ (found - truth) / Σ truth
    double noise = 0;     ///< what the truth is unsure by, in the measure of `relative`
};

FluenceError error_of(const std::vector<Rgb>& found, const Fluence& truth);

/// Of channel c over the `block`² pixels of a block.
double block_mean(const Frame& frame, int block_x, int block_y, int c, int block);
/// Over means of `block`² pixels, of those blocks where something is seen.
FluenceError error_of(const Frame& found, const Frame& truth, const PathStatistics& sureness, int block);

/// J at points between the nodes: trilinear, in matter by the weights of nodes, in the air by what these leave, so that
/// neither takes the other's light.
std::vector<Rgb> light_between(const TransportNodes& nodes, const std::vector<Vec3>& points, bool in_matter);

/// Points, pictures and their truths of a subject under a light.
class TransportJudge {
public:
    struct Effort {
        int air = 256, matter = 128, paths = 2048, paths_a_pixel = 64;
    };
    TransportJudge(const ScatteringSubject& subject, ScatteringCase which, const Effort& effort, Progress& progress);

    /// Light on a grid of so many cells, after at most so many iterations (none: until it changes no more); 0: light
    /// that is scattered but once.
    TransportNodes nodes(int grid, std::optional<int> iterations) const;
    FluenceError in_air(const TransportNodes& nodes) const;
    FluenceError in_matter(const TransportNodes& nodes) const;

    /// L = ∫ κ a J T dt by marching through the medium of the paths, 64 steps a smallest voxel edge, J as pictures of
    /// particles look it up: what this light makes of a picture, whatever a ray caster adds. Some CPU seconds.
    Frame picture(const TransportNodes& nodes) const;
    FluenceError of_picture(const Frame& frame, int block = 4) const;
    const Frame& truth() const { return picture_.first; }
    const JudgedPoints& points() const { return points_; }

private:
    Rgb light_along(const ShownLight& shown, Vec3 eye, Vec3 direction) const;

    const ScatteringSubject& subject_;
    ScatteringCase which_;
    Progress& progress_;
    JudgedPoints points_;
    Fluence air_, matter_;
    std::pair<Frame, PathStatistics> picture_;
};

}  // namespace chiaro::bench
