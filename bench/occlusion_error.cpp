#include "occlusion_error.h"

#include <cmath>
#include <numeric>
#include <random>

#include "classify/medium.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/optics.h"

namespace chiaro::bench {

std::vector<std::pair<std::string, TransferFunction>> four_functions(double low, double high) {
    const auto of = [&](std::vector<std::pair<double, double>> points) {
        TransferFunction tf;
        for (const auto& [share, opacity] : points)
            tf.points.push_back({low + share * (high - low), {1, 1, 1}, opacity});
        return tf;
    };
    return {{"ramp", of({{0.05, 0}, {0.6, 1}})},
            {"dense", of({{0.5, 0}, {0.7, 1}})},
            {"layer", of({{0.12, 0}, {0.2, 0.5}, {0.3, 0.5}, {0.38, 0}})},
            {"fog", of({{0.08, 0}, {0.12, 0.05}})}};
}

std::vector<OcclusionError> occlusion_errors(const DeviceVolume& volume, const LocalHistograms& h,
                                             const std::vector<std::pair<std::string, TransferFunction>>& functions,
                                             int probes) {
    const Device& device = volume.data().device;
    Progress progress;
    const BinnedCells cells = bin_cells(volume.data().device, volume.data(), progress);
    const Ball ball(h.radius, true);
    const int bins = cells.binning.count;
    const ExactHistograms exact(device, cells, ball);
    std::vector<std::vector<float>> alphas;
    std::vector<std::vector<std::array<float, 4>>> sums;
    for (const auto& [name, tf] : functions) {
        const Medium medium = classify(volume, tf, {});
        const BinOptics optics = optics_of_bins(medium.data(), h, "");
        alphas.push_back(optics.alpha), sums.push_back(codeword_sums(device, h, optics));
    }
    std::vector<OcclusionError> errors(functions.size());
    std::mt19937 random(11);
    std::vector<float> histogram;
    for (int i = 0; i < probes; ++i) {
        const std::size_t node = random() % h.node_count(), half = random() % 2;
        const int x = int(node % std::size_t(h.nodes[0])),
                  y = int(node / std::size_t(h.nodes[0]) % std::size_t(h.nodes[1])),
                  z = int(node / std::size_t(h.nodes[0]) / std::size_t(h.nodes[1])), s = h.subsample;
        histogram.assign(std::size_t(bins), 0);
        exact.add(x * s, y * s, z * s, half ? ExactHistograms::Half::backward : ExactHistograms::Half::forward,
                  histogram.data());
        const CodewordPair pair = h.pairs()[node];
        for (std::size_t f = 0; f < functions.size(); ++f) {
            const double ground_truth = std::inner_product(histogram.begin(), histogram.end(), alphas[f].begin(), 0.0);
            const double error = sums[f][half ? pair.backward : pair.forward][3] - ground_truth;
            errors[f].rmse += error * error, errors[f].bias += error;
        }
    }
    for (OcclusionError& e : errors) e = {std::sqrt(e.rmse / probes), e.bias / probes};
    return errors;
}

}  // namespace chiaro::bench
