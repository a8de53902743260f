// Truths of local histograms (spec 3.9): closed forms and brute force, packing, codebooks, and that paths agree.
#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "fixtures.h"
#include "illumination/histogram/emission.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/optics.h"
#include "illumination/histogram/source.h"

namespace chiaro {
namespace {

using testing::sampled;
using testing::tested_device;
using Histogram = std::vector<double>;

/// Blobs, a wall and some noise.
Volume clutter(std::array<int, 3> n = {45, 41, 47}) {
    return sampled<std::uint8_t>(n, [](double x, double y, double z) {
        const double soft = 100 + 90 * std::sin(0.31 * x + 0.2) * std::sin(0.23 * y + 0.7) * std::sin(0.27 * z);
        const int noise = (int(x) * 73 + int(y) * 151 + int(z) * 199) % 7;
        return x > 30 && x < 33 ? 230 : soft > 110 ? soft + noise : 10;
    });
}

BinnedCells binned(const Volume& volume) {
    Progress progress;
    return bin_cells(tested_device(), upload(tested_device(), volume).data(), progress);
}

/// Spec 3.1, word for word, in double.
Histogram by_definition(const BinnedCells& cells, int x, int y, int z, int r, bool forward) {
    Histogram histogram(std::size_t(cells.binning.count), 0.0);
    const auto g = cells.gradient(x, y, z);
    double weights = 0;
    for (int dz = -r; dz <= r; ++dz)
        for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx) {
                const int square = dx * dx + dy * dy + dz * dz;
                if (square == 0 || square > r * r) continue;
                weights += 1.0 / square;
                const int i = x + dx, j = y + dy, k = z + dz;
                if (i < 0 || i >= cells.grid.count[0] || j < 0 || j >= cells.grid.count[1] || k < 0 ||
                    k >= cells.grid.count[2])
                    continue;
                const double ahead =
                    (forward ? 1.0 : -1.0) * (dx * double(g[0]) + dy * double(g[1]) + dz * double(g[2]));
                histogram[cells.data()[cells.grid.index(i, j, k)]] += (ahead > 0 ? 1 : ahead < 0 ? 0 : 0.5) / square;
            }
    for (double& share : histogram) share *= 2 / weights;
    return histogram;
}

/// Cells of a row that lie next to each other.
struct CellRun {
    int x, y, z, count;
};
/// Both histograms of each by ExactHistograms.
std::vector<float> exact(const BinnedCells& cells, const CellRun& run, int radius,
                         const Device& device = tested_device()) {
    const Ball ball(radius, true);
    const ExactHistograms histograms(device, cells, ball);
    std::vector<float> found(std::size_t(2 * run.count * cells.binning.count));
    for (int i = 0; i < run.count; ++i)
        histograms.find(run.x + i, run.y, run.z, found.data() + 2 * i * cells.binning.count);
    return found;
}

double sum(const float* first, int count) { return std::accumulate(first, first + count, 0.0); }

std::vector<PackedHistogram> all_histograms(const Device& device, const HistogramData& data, HistogramPath path) {
    const auto source = make_source(device, data, path);
    std::vector<PackedHistogram> all(std::size_t(2 * source->bins()) * data.cells.grid.size());
    const BlockMap blocks(data.cells.grid.count);
    for (std::size_t b = 0; b < blocks.holds.size(); ++b) {
        const auto range = blocks.cells(b, data.cells.grid.count);
        source->find(
            b, 1, [](int, int) { return true; },
            [&](int y, int z, const PackedHistogram* row) {
                const std::size_t at = data.cells.grid.index(range[0].first, y, z) * std::size_t(2 * source->bins());
                std::copy_n(row, (range[0].second - range[0].first) * 2 * source->bins(), all.data() + at);
            });
    }
    return all;
}

HistogramData data_of(const Volume& volume, int radius, int packed = 16,
                      HistogramPacking packing = HistogramPacking::uniform) {
    HistogramData data{binned(volume), {}, radius};
    data.packing = make_packing(packing, packed, data.cells.counts());
    return data;
}

TEST(HistogramBins, HoldOneValueWhereTheyCan) {
    const Binning bytes = binned(clutter()).binning;
    EXPECT_EQ(bytes.width, 1);
    for (int value : {10, 11, 100, 230}) EXPECT_EQ(bytes.stored_of(bytes.bin_of(value)), value);
    const auto ramp = [](double scale) { return [scale](double x, double, double) { return scale * x; }; };
    EXPECT_EQ(binned(sampled<std::uint16_t>({41, 3, 3}, ramp(100))).binning.count, 4001);
    const Binning wide = binned(sampled<std::uint16_t>({41, 3, 3}, ramp(1600))).binning;
    EXPECT_EQ(wide.count, 4096);
    EXPECT_NEAR(wide.stored_of(wide.bin_of(32000)), 32000, wide.width / 2);
    EXPECT_EQ(binned(sampled<float>({41, 3, 3}, ramp(0.1))).binning.count, 4096);
    EXPECT_EQ(binned(sampled<float>({4, 3, 3}, ramp(0))).binning.count, 1);
}

TEST(HistogramBins, LieOnCubicCells) {
    Volume thick = sampled<std::uint8_t>({9, 8, 5}, [](double, double, double z) { return 40 * z; });
    thick.geometry.spacing_mm = {1, 1, 2};
    const BinnedCells cells = binned(thick);
    EXPECT_EQ(cells.grid.count, (std::array{9, 8, 10}));
    // Cell 4 has its centre at voxel 1.75.
    EXPECT_EQ(cells.binning.stored_of(cells.data()[cells.grid.index(3, 3, 4)]), 70);
    EXPECT_EQ(cells.gradient(3, 3, 4), (std::array{0.0f, 0.0f, 20.0f}));
}

TEST(LocalHistograms, AreWhatTheDefinitionSays) {
    const BinnedCells cells = binned(clutter());
    const int bins = cells.binning.count;
    for (const CellRun& run : {CellRun{5, 20, 22, 16}, {29, 40, 0, 16}, {0, 0, 0, 7}}) {
        const auto found = exact(cells, run, 7);
        for (int i = 0; i < run.count; i += 3)
            for (const bool forward : {true, false}) {
                const Histogram ground_truth = by_definition(cells, run.x + i, run.y, run.z, 7, forward);
                for (int j = 0; j < bins; ++j)
                    ASSERT_NEAR(found[std::size_t((2 * i + !forward) * bins + j)], ground_truth[std::size_t(j)], 1e-5)
                        << i << " " << j;
            }
    }
}

TEST(LocalHistograms, OfOneHalfAreThoseOfBoth) {
    const BinnedCells cells = binned(clutter());
    const int bins = cells.binning.count;
    const Ball ball(6, true);
    const ExactHistograms histograms(tested_device(), cells, ball);
    for (const CellRun& run : {CellRun{9, 20, 22, 5}, {0, 1, 40, 5}}) {
        const auto found = exact(cells, run, 6);
        for (int i = 0; i < run.count; ++i) {
            std::vector<float> one(std::size_t(bins), 0);
            histograms.add(run.x + i, run.y, run.z, ExactHistograms::Half::backward, one.data());
            for (int j = 0; j < bins; ++j)
                ASSERT_NEAR(one[std::size_t(j)], found[std::size_t((2 * i + 1) * bins + j)], 2e-6);
        }
    }
}

TEST(LocalHistograms, SumToOneInsideAndMissWhatLiesOutside) {
    const BinnedCells cells = binned(clutter());
    const int bins = cells.binning.count;
    const auto inside = exact(cells, {14, 20, 22, 16}, 8), corner = exact(cells, {0, 0, 0, 1}, 8);
    for (int i = 0; i < 32; ++i) EXPECT_NEAR(sum(&inside[std::size_t(i * bins)], bins), 1, 1e-5);
    EXPECT_LT(sum(corner.data(), 2 * bins), 2 * 0.3);
}

TEST(LocalHistograms, SwapTheirHalvesWithTheGradient) {
    Volume turned = clutter();
    for (auto& v : turned.as<std::uint8_t>()) v = std::uint8_t(240 - v);
    const BinnedCells cells = binned(clutter()), other = binned(turned);
    const int bins = cells.binning.count;
    ASSERT_EQ(other.binning.count, bins);
    const auto a = exact(cells, {12, 20, 22, 16}, 6), b = exact(other, {12, 20, 22, 16}, 6);
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < bins; ++j) {
            const std::size_t forward = std::size_t(2 * i * bins + j),
                              backward = std::size_t((2 * i + 1) * bins + bins - 1 - j);
            ASSERT_NEAR(a[forward], b[backward], 2e-6);
        }
}

TEST(LocalHistograms, AreTheSameOnEveryInstructionSet) {
    const BinnedCells cells = binned(clutter());
    const auto plain = exact(cells, {11, 20, 0, 16}, 7, Device::cpu(1, Isa::scalar));
    const HistogramData data = data_of(clutter({37, 35, 20}), 6, 16, HistogramPacking::paper);
    const auto fast = all_histograms(Device::cpu(1, Isa::scalar), data, HistogramPath::fast);
    for (const Isa isa : available_isas()) {
        EXPECT_EQ(exact(cells, {11, 20, 0, 16}, 7, Device::cpu(1, isa)), plain) << name_of(isa);
        EXPECT_EQ(all_histograms(Device::cpu(1, isa), data, HistogramPath::fast), fast) << name_of(isa);
    }
}

TEST(LocalHistograms, SweptEqualBruteForceInTheirQuantity) {
    for (const auto packing : {HistogramPacking::uniform, HistogramPacking::paper}) {
        const HistogramData data = data_of(clutter({37, 35, 9}), 5, 16, packing);
        const auto swept = all_histograms(tested_device(), data, HistogramPath::sweep);
        const Ball ball(5, false);
        const int bins = data.cells.binning.count;
        const ExactHistograms ground_truth(tested_device(), data.cells, ball);
        for (const auto& [x, y, z] : {std::array{0, 0, 0}, {36, 34, 8}, {20, 17, 4}, {32, 3, 7}}) {
            std::vector<float> full(std::size_t(bins), 0), packed(std::size_t(data.packing.packed));
            ground_truth.add(x, y, z, ExactHistograms::Half::whole, full.data());
            data.packing.pack(full, packed);
            for (int half = 0; half < 2; ++half)
                for (int k = 0; k < 16; ++k)
                    ASSERT_NEAR(swept[(data.cells.grid.index(x, y, z) * 2 + std::size_t(half)) * 16 + std::size_t(k)] /
                                    double(packed_one),
                                packed[std::size_t(k)], 6e-5)
                        << x << " " << k;
        }
    }
}

TEST(LocalHistograms, FastOnesAreNearExactOnes) {
    for (const auto& [radius, most] : {std::pair{4, 0.045}, {8, 0.03}, {12, 0.025}}) {
        const HistogramData data = data_of(clutter(), radius);
        const auto fast = all_histograms(tested_device(), data, HistogramPath::fast),
                   exact = all_histograms(tested_device(), data, HistogramPath::exact);
        double squares = 0, worst_sum = 0;
        for (std::size_t i = 0; i < fast.size(); i += 16) {
            double o = 0, o_fast = 0, of_ball = 0;  // opaque: the upper half of the bins
            for (std::size_t k = 0; k < 16; ++k) {
                if (k >= 8) o += exact[i + k], o_fast += fast[i + k];
                const std::size_t other = i % 32 ? i - 16 : i + 16;
                of_ball += fast[i + k] + fast[other + k] - exact[i + k] - exact[other + k];
            }
            squares += std::pow((o - o_fast) / packed_one, 2);
            worst_sum = std::max(worst_sum, std::abs(of_ball) / (2.0 * packed_one));
        }
        EXPECT_LT(std::sqrt(squares / double(fast.size() / 16)), most) << radius;
        EXPECT_LT(worst_sum, 0.1) << radius;  // noise, and a border that cuts boxes otherwise than the ball
    }
}

TEST(Packing, IsALinearMapWhoseColumnsSumToOne) {
    std::vector<std::uint64_t> counts(300);
    std::mt19937 random(4);
    for (auto& count : counts) count = random() % 50;
    for (const auto kind : {HistogramPacking::paper, HistogramPacking::uniform, HistogramPacking::cumulative}) {
        const Packing packing = make_packing(kind, 21, counts);
        ASSERT_EQ(packing.packed, 21);
        std::vector<float> histogram(300), packed(21);
        for (std::size_t j = 0; j < 300; ++j) {
            std::fill(histogram.begin(), histogram.end(), 0.0f);
            histogram[j] = 1;
            packing.pack(histogram, packed);
            EXPECT_EQ(sum(packed.data(), 21), 1);
        }
        EXPECT_TRUE(std::is_sorted(packing.low.begin(), packing.low.end()));
        EXPECT_EQ(packing.is_one_to_one(), kind != HistogramPacking::paper);
    }
    EXPECT_EQ(make_packing(HistogramPacking::uniform, 64, std::vector<std::uint64_t>(5, 1)).packed, 5);
}

TEST(Packing, OfThePaperGivesTheSmallestBinToItsNeighbours) {
    const std::vector<std::uint64_t> counts{5, 1, 3, 9};
    const Packing three = make_packing(HistogramPacking::paper, 3, counts),
                  two = make_packing(HistogramPacking::paper, 2, counts);
    EXPECT_EQ(three.low, (std::vector<std::uint16_t>{0, 0, 1, 2}));
    EXPECT_EQ(three.share, (std::vector<std::uint16_t>{256, 128, 256, 256}));
    // Now they hold 5.5, 3.5 and 9: the second goes too, with its half of the first that went.
    EXPECT_EQ(two.low, (std::vector<std::uint16_t>{0, 0, 0, 1}));
    EXPECT_EQ(two.share, (std::vector<std::uint16_t>{256, 192, 128, 256}));
    // At an end all goes to the one neighbour.
    EXPECT_EQ(make_packing(HistogramPacking::paper, 2, std::vector<std::uint64_t>{1, 5, 9}).low,
              (std::vector<std::uint16_t>{0, 0, 1}));
}

TEST(Packing, CumulativeKeepsTheCumulativeHistogram) {
    std::vector<std::uint64_t> counts(256, 1);
    for (int j = 100; j < 110; ++j) counts[std::size_t(j)] = 500 + 97 * std::uint64_t(j % 4);
    const auto error = [&](const Packing& packing) {
        std::vector<double> mass(std::size_t(packing.packed)), width(mass.size());
        for (std::size_t j = 0; j < 256; ++j) mass[packing.low[j]] += double(counts[j]), width[packing.low[j]] += 1;
        double difference = 0, squares = 0;
        for (std::size_t j = 0; j < 256; ++j) {
            difference += double(counts[j]) - mass[packing.low[j]] / width[packing.low[j]];
            squares += difference * difference;
        }
        return squares;
    };
    EXPECT_LT(error(make_packing(HistogramPacking::cumulative, 16, counts)),
              0.05 * error(make_packing(HistogramPacking::uniform, 16, counts)));
}

LocalHistograms histograms_of(const Volume& volume, HistogramSettings settings,
                              const Device& device = tested_device()) {
    StageTimer timer;
    Progress progress;
    return find_local_histograms(device, upload(device, volume).data(), settings, timer, progress);
}

constexpr HistogramSettings small{.radius = 6, .clusters = 100, .packed_bins = 16};

TEST(LocalHistograms, HaveCodewordsThatSumToOneAtMost) {
    const LocalHistograms h = histograms_of(clutter(), small);
    EXPECT_GT(h.codewords, 90);
    double largest = 0;
    for (int w = 0; w < h.codewords; ++w) {
        double total = 0;
        for (int j = 0; j < h.stride; ++j)
            total += double(h.shares[std::size_t(w * h.stride + j)]) * h.scale[std::size_t(w)];
        largest = std::max(largest, total);
        EXPECT_LT(total, 1.001);
    }
    EXPECT_GT(largest, 0.99);  // all members inside
    for (const CodewordPair& pair : h.pairs()) ASSERT_TRUE(pair.forward < h.codewords && pair.backward < h.codewords);
}

TEST(LocalHistograms, AreTheSameForAnyNumberOfThreadsAndInstructionSet) {
    for (const int subsample : {1, 2}) {
        HistogramSettings settings = small;
        settings.subsample = subsample;
        const LocalHistograms one = histograms_of(clutter(), settings, Device::cpu(1, Isa::scalar));
        for (const Isa isa : available_isas()) {
            const LocalHistograms other = histograms_of(clutter(), settings, Device::cpu(3, isa));
            ASSERT_EQ(one.identifiers.size(), other.identifiers.size());
            EXPECT_TRUE(std::equal(one.identifiers.data(), one.identifiers.data() + one.identifiers.size(),
                                   other.identifiers.data()));
            EXPECT_TRUE(
                std::equal(one.displaced.data(), one.displaced.data() + one.displaced.size(), other.displaced.data()));
            EXPECT_EQ(one.shares, other.shares);
            EXPECT_EQ(one.scale, other.scale);
        }
    }
}

Medium medium_of(const Volume& volume, const TransferFunction& tf, const Shape& shape = {}) {
    return classify(upload(tested_device(), volume), tf, shape);
}

TEST(CodewordSums, AreOneForOpaqueMatterAndNothingForClear) {
    const LocalHistograms h = histograms_of(clutter(), small);
    const auto sums = [&](const TransferFunction& tf) {
        return codeword_sums(tested_device(), h, optics_of_bins(medium_of(clutter(), tf).data(), h, ""));
    };
    double largest = 0;
    for (const auto& s : sums(testing::constant(1))) largest = std::max(largest, double(s[3]));
    EXPECT_NEAR(largest, 1, 5e-3);  // hardly a word has only members far from the border
    for (const auto& s : sums(testing::constant(0))) EXPECT_EQ(s, (std::array{0.0f, 0.0f, 0.0f, 0.0f}));
    // α of one edge, whatever length the transfer function's opacities belong to.
    TransferFunction long_unit = testing::constant(0.5, {0.2, 0.4, 0.8});
    long_unit.opacity_unit = 2;
    for (const auto& s : sums(long_unit)) {
        EXPECT_LT(s[3], 1 - std::sqrt(0.5) + 1e-3);
        EXPECT_NEAR(s[0], 0.2 * s[3], 1e-5);
        EXPECT_NEAR(s[2], 0.8 * s[3], 1e-5);
    }
}

TEST(CodewordSums, AreTheSameOnEveryInstructionSet) {
    const LocalHistograms h = histograms_of(clutter(), small);
    const BinOptics optics = optics_of_bins(medium_of(clutter(), testing::two_materials()).data(), h, "100:200=3");
    const auto plain = codeword_sums(Device::cpu(1, Isa::scalar), h, optics);
    for (std::size_t w = 0; w < plain.size(); ++w) {
        double o = 0, r = 0;
        for (std::size_t j = 0; j < optics.alpha.size(); ++j) {
            const double share = double(h.shares[w * std::size_t(h.stride) + j]) * h.scale[w];
            o += share * optics.alpha[j], r += share * optics.alpha[j] * optics.rgb[j][0] * optics.emission[j];
        }
        ASSERT_NEAR(plain[w][3], o, 1e-5);
        ASSERT_NEAR(plain[w][0], r, 1e-5);
    }
    for (const Isa isa : available_isas()) EXPECT_EQ(codeword_sums(Device::cpu(2, isa), h, optics), plain);
}

TEST(Emission, IsReadFromTextAndRefusesNonsense) {
    const EmissionMapping box("40:80=3");
    EXPECT_EQ(box.at(39), 1);
    EXPECT_EQ(box.at(40), 3);
    EXPECT_EQ(box.at(60), 3);
    EXPECT_EQ(box.at(81), 1);
    for (const char* text : {"40:80", "80:40=2", "a:b=2", "40:80=0.5", "/no/such/file"})
        EXPECT_THROW(EmissionMapping{text}, Error) << text;
}

}  // namespace
}  // namespace chiaro
