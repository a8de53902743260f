// How far the occlusion that local histograms give is from direct sums over the ball.
#pragma once
#include <chiaro/medium.h>

#include <string>
#include <utility>
#include <vector>

#include "illumination/histogram/histograms.h"

namespace chiaro::bench {

/// Four transfer functions over values from `low` to `high`: a long ramp, what is dense, a layer of middle values, fog.
std::vector<std::pair<std::string, TransferFunction>> four_functions(double low, double high);

struct OcclusionError {
    double rmse = 0, bias = 0;  ///< of found - ground truth
};
/// O of both halves of `probes` nodes at random against Σ α LH by brute force, for each of the functions.
std::vector<OcclusionError> occlusion_errors(const DeviceVolume& volume, const LocalHistograms& histograms,
                                             const std::vector<std::pair<std::string, TransferFunction>>& functions,
                                             int probes);

}  // namespace chiaro::bench
