// What a GPU prepares of local histograms, number by number against the CPU's.
#include <cstring>

#include "cuda_case.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/training_set.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Blobs, a wall and some noise, over more blocks than one along x and z.
Volume clutter() {
    return sampled<std::uint8_t>({45, 21, 35}, [](double x, double y, double z) {
        const double soft = 100 + 90 * std::sin(0.31 * x + 0.2) * std::sin(0.23 * y + 0.7) * std::sin(0.27 * z);
        const int noise = (int(x) * 73 + int(y) * 151 + int(z) * 199) % 7;
        return x > 30 && x < 33 ? 230 : soft > 110 ? soft + noise : 10;
    });
}

LocalHistograms prepared(const Device& device, const Volume& volume, const HistogramSettings& settings) {
    StageTimer timer;
    Progress progress;
    return find_local_histograms(device, upload(device, volume).data(), settings, timer, progress);
}

template <class Buffer>
std::size_t different_bytes(const Buffer& a, const Buffer& b) {
    EXPECT_EQ(a.size(), b.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a.data()[i] != b.data()[i];
    return count;
}

/// Returns how many words they are.
int expect_same_histograms(const Device& gpu, const Volume& volume, const HistogramSettings& settings) {
    const LocalHistograms expected = prepared(cpu(), volume, settings), found = prepared(gpu, volume, settings);
    EXPECT_EQ(found.codewords, expected.codewords);
    EXPECT_EQ(found.distortions, expected.distortions);
    EXPECT_EQ(different_bytes(found.identifiers, expected.identifiers), 0u);
    EXPECT_EQ(different_bytes(found.displaced, expected.displaced), 0u);
    EXPECT_EQ(found.shares, expected.shares);
    EXPECT_EQ(found.scale, expected.scale);
    return found.codewords;
}

constexpr HistogramSettings small{.radius = 6, .clusters = 60, .packed_bins = 16};

}  // namespace

TEST_F(Gpus, PrepareLocalHistogramsAsTheCpuDoes) { expect_same_histograms(gpu, clutter(), small); }

TEST_F(Gpus, PrepareLocalHistogramsByEveryPath) {
    HistogramSettings settings = small;
    settings.clusters = 30;
    for (const auto path : {HistogramPath::exact, HistogramPath::sweep}) {
        settings.path = path, settings.packing = HistogramPacking::uniform, settings.subsample = 1;
        expect_same_histograms(gpu, clutter(), settings);
        settings.packing = HistogramPacking::paper, settings.packed_bins = 21, settings.subsample = 4;
        expect_same_histograms(gpu, clutter(), settings);
    }
}

TEST_F(Gpus, FindTheBinsOfCells) {
    const auto expect_same_bins = [&](Volume volume) {
        for (const Vec3 spacing_mm : {Vec3{1, 1, 1}, Vec3{1, 1.4, 2.3}}) {
            volume.geometry.spacing_mm = spacing_mm;
            Progress progress;
            const BinnedCells expected = bin_cells(cpu(), upload(cpu(), volume).data(), progress),
                              found = bin_cells(gpu, upload(gpu, volume).data(), progress);
            EXPECT_EQ(found.binning, expected.binning);
            EXPECT_EQ(different_bytes(found.buffer, expected.buffer), 0u);
            EXPECT_EQ(found.counts(), expected.counts());
        }
    };
    const auto slope = [](double x, double y, double z) { return 900 * x + 70 * std::sin(y) * z; };
    expect_same_bins(clutter());
    expect_same_bins(sampled<std::uint16_t>({33, 9, 6}, slope));
    expect_same_bins(sampled<float>({2, 40, 7}, slope));
}

TEST_F(Gpus, ChooseTheTrainingSet) {
    const auto sampled_by = [](const Device& device, const Volume& volume) {
        Progress progress;
        HistogramData data{bin_cells(device, upload(device, volume).data(), progress), {}, 4};
        data.packing = make_packing(HistogramPacking::uniform, 16, data.cells.counts());
        return sample_histograms(device, data, HistogramPath::fast, 900, progress);
    };
    const auto flat = [](double, double, double) { return 7.0; };
    for (const Volume& volume : {clutter(), sampled<float>({9, 8, 70}, flat), sampled<float>({1, 1, 1}, flat)})
        EXPECT_EQ(different_bytes(sampled_by(gpu, volume).buffer, sampled_by(cpu(), volume).buffer), 0u);
}

TEST_F(Gpus, ListTheNeighboursOfCodewords) {
    constexpr int bins = 16;
    for (const int count : {1, 2, 40, 300}) {
        std::vector<PackedHistogram> codewords;
        for (int i = 0; i < count * bins; ++i)
            codewords.push_back(PackedHistogram(i / bins * 37 % 7 * (i % bins) * 30));
        for (const auto metric : {HistogramMetric::l2, HistogramMetric::l1, HistogramMetric::lmax}) {
            const Codebook here(cpu(), bins, metric, codewords), there(gpu, bins, metric, codewords);
            const kernel::CodebookView expected = here.view(), found = there.view();
            ASSERT_EQ(found.listed, std::min(count - 1, 256));
            for (int i = 0; i < count * found.listed; ++i) {
                ASSERT_EQ(found.neighbours[i], expected.neighbours[i]) << i;
                ASSERT_EQ(found.distances[i], expected.distances[i]) << i;
            }
        }
    }
}

TEST_F(Gpus, PrepareLocalHistogramsOfEverySetting) {
    HistogramSettings settings = small;
    settings.packing = HistogramPacking::paper, settings.packed_bins = 21;
    expect_same_histograms(gpu, clutter(), settings);
    for (const auto metric : {HistogramMetric::l1, HistogramMetric::lmax}) {
        settings.metric = metric, settings.subsample = metric == HistogramMetric::l1 ? 2 : 4;
        expect_same_histograms(gpu, clutter(), settings);
    }
    settings.clusters = 1;
    expect_same_histograms(gpu, clutter(), settings);
    expect_same_histograms(gpu, sampled<float>({5, 3, 4}, [](double, double, double) { return 0.0; }), small);
}

TEST_F(Gpus, FindMoreCodewordsThanThereIsRoomForAtOnce) {
    HistogramSettings settings = small;
    settings.clusters = 600;  // of 4096 bins, half a MiB each
    const auto slope = [](double x, double y, double z) { return 0.1 * x + std::sin(y) * z + (int(x + y) % 3); };
    EXPECT_GT(expect_same_histograms(gpu, sampled<float>({9, 8, 7}, slope), settings), 512);
}

TEST_F(Gpus, KeepTheIdentifiersThatTheyFound) {
    const auto& device_cache = *gpu.stream->device_cache();
    const DeviceVolume volume = upload(gpu, clutter());
    StageTimer timer;
    Progress progress;
    const LocalHistograms h = find_local_histograms(gpu, volume.data(), small, timer, progress);
    const auto copied = device_cache.copied_bytes();
    for (const HostArray& made : {HostArray::of(h.life, h.identifiers), h.displaced.array()})
        gpu.stream->device_cache()->of(made, *gpu.stream);
    EXPECT_EQ(device_cache.copied_bytes(), copied) << "what was made there is copied again";
    EXPECT_LT(copied - volume.data().bricks.size(), 60000u)
        << "more than the voxels and words: the training set has 123 KB";
}
