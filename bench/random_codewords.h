// A table of words to time: 2048 of 4096 bins, of random numbers.
#pragma once
#include <memory>
#include <random>

#include "illumination/histogram/optics.h"
#include "rows.h"

namespace chiaro::bench {

struct RandomCodewords {
    const std::shared_ptr<LocalHistograms> histograms = std::make_shared<LocalHistograms>();
    BinOptics optics;

    explicit RandomCodewords(const Setup& setup) {
        LocalHistograms& h = *histograms;
        h.codewords = setup.quick ? 64 : 2048, h.stride = 4096, h.binning.count = 4096;
        std::mt19937 random(9);
        h.shares.resize(std::size_t(h.codewords) * 4096), h.scale.assign(std::size_t(h.codewords), 1e-6f);
        for (auto& share : h.shares) share = std::uint16_t(random());
        for (int j = 0; j < 4096; ++j) optics.alpha.push_back(0.5f), optics.rgb.push_back({0.1f, 0.5f, 0.9f});
    }
    std::size_t bytes() const { return histograms->shares.size() * sizeof histograms->shares[0]; }
    void sum(const Device& device) const { codeword_sums(device, *histograms, optics); }
};

}  // namespace chiaro::bench
