// Directions drawn in proportion to a probe's light.
#pragma once
#include <vector>

#include "illumination/sh/rotation.h"

namespace chiaro {

struct ProbePicture;

/// A density over the sphere in proportion to the luminance of the pixel, constant in each: first a row by its share of
/// the light, then a pixel of it (Pharr, Jakob and Humphreys, Physically Based Rendering, 14.2.4). In the probe's own
/// frame. A black probe is sampled evenly. Memory: a double a pixel.
class ImportanceTable {
public:
    /// The picture must stay: it is looked at again.
    explicit ImportanceTable(const ProbePicture& picture);

    struct Sample {
        Vec3 direction;  ///< unit
        double density;  ///< per steradian
    };
    /// u1 and u2 in [0, 1); what they leave within the pixel places the direction evenly in it.
    Sample sample(double u1, double u2) const;
    /// Per steradian, of a unit direction.
    double density(Vec3 direction) const;

private:
    double density_in(int x, int y) const;

    const ProbePicture& picture_;
    std::vector<double> rows_;     ///< share of the light in the rows before and in each
    std::vector<double> columns_;  ///< of a row's light, in its pixels before and in each
};

}  // namespace chiaro
