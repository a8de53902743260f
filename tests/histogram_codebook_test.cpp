// The codebook of local histograms: nearest words, metrics, training.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "devices.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/source.h"

namespace chiaro {
namespace {

using testing::tested_device;

/// Vectors in a few groups, none of them equal.
std::vector<PackedHistogram> vectors(std::size_t count, int bins = 32) {
    std::mt19937 random(7);
    std::vector<PackedHistogram> all;
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < bins; ++k)
            all.push_back(PackedHistogram(k == int(i % 9) ? 15000 + int(random() % 3000) : int(random() % 500)));
    return all;
}

TEST(Codebook, FindsTheNearestCodewordOfAll) {
    const auto codewords = vectors(700), some = vectors(333);
    for (const auto metric : {HistogramMetric::l2, HistogramMetric::l1, HistogramMetric::lmax}) {
        const Codebook codebook(tested_device(), 32, metric, codewords);
        std::vector<std::int32_t> all(700), found(333);
        for (const Isa isa : available_isas()) {
            const auto kernels = kernel::histogram_functions_for(isa);
            std::vector<std::uint16_t> nearest(333, 5);
            kernels.assign_each(codebook.view(), some.data(), 333, nearest.data(), found.data());
            for (std::size_t i = 0; i < 333; ++i) {
                kernels.differences_to(codebook.view(), some.data() + i * 32, all.data());
                const auto least = std::min_element(all.begin(), all.end());
                ASSERT_EQ(nearest[i], least - all.begin()) << i;
                ASSERT_EQ(found[i], *least);
            }
        }
    }
}

TEST(Codebook, TellsPureVectorsApart) {
    // The farthest that two can be: nothing in common, all in one bin each.
    std::vector<PackedHistogram> codewords(2 * 16, 0), pure(16, 0);
    codewords[3] = codewords[16 + 9] = pure[9] = packed_one;
    for (const auto metric : {HistogramMetric::l2, HistogramMetric::l1, HistogramMetric::lmax}) {
        const Codebook codebook(tested_device(), 16, metric, codewords);
        for (const Isa isa : available_isas()) {
            const auto kernels = kernel::histogram_functions_for(isa);
            std::int32_t to[2], found;
            std::uint16_t nearest = 0;
            kernels.differences_to(codebook.view(), pure.data(), to);
            EXPECT_GT(to[0], 0);
            EXPECT_EQ(to[1], 0);
            kernels.assign_each(codebook.view(), pure.data(), 1, &nearest, &found);
            EXPECT_EQ(nearest, 1);
            EXPECT_EQ(found, 0);
        }
    }
}

TEST(Codebook, MeasuresByItsMetric) {
    std::vector<PackedHistogram> codewords(2 * 16, 0);
    codewords[0] = 300, codewords[17] = 400;
    std::int32_t to[2];
    const auto difference = [&](HistogramMetric metric) {
        const Codebook codebook(tested_device(), 16, metric, codewords);
        kernel::histogram_functions_for(best_isa()).differences_to(codebook.view(), codewords.data(), to);
        EXPECT_EQ(to[0], 0);
        return to[1];
    };
    EXPECT_EQ(difference(HistogramMetric::l2), 250000);
    EXPECT_EQ(difference(HistogramMetric::l1), 700);
    EXPECT_EQ(difference(HistogramMetric::lmax), 400);
}

TEST(Codebook, DistortionNeverRises) {
    const auto all = vectors(3000);
    Progress progress;
    for (const auto metric : {HistogramMetric::l2, HistogramMetric::l1, HistogramMetric::lmax}) {
        Training training{37, metric, 1e-3, {}};
        const Codebook codebook = train_codebook(tested_device(), all, 32, training, progress);
        EXPECT_EQ(codebook.count(), 37);
        EXPECT_TRUE(std::is_sorted(training.distortions.rbegin(), training.distortions.rend()));
        EXPECT_LT(training.distortions.back(), 0.5 * training.distortions.front());
        Training again{37, metric, 1e-3, {}};
        EXPECT_EQ(train_codebook(Device::cpu(1, Isa::scalar), all, 32, again, progress).codewords(),
                  codebook.codewords());
    }
}

TEST(Codebook, HasNoMoreCodewordsThanThereAreVectors) {
    const auto few = vectors(20);
    Training training{64, HistogramMetric::l2, 1e-3, {}};
    Progress progress;
    const Codebook codebook = train_codebook(tested_device(), few, 32, training, progress);
    EXPECT_EQ(codebook.count(), 20);
    EXPECT_EQ(training.distortions.back(), 0);
}

}  // namespace
}  // namespace chiaro
