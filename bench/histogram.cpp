// Local histograms: the published table of preprocessing times, what an edit costs, and errors of occlusion.
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "classify/medium.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/optics.h"
#include "illumination/histogram/source.h"
#include "occlusion_error.h"
#include "random_codewords.h"
#include "rows.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

struct Subject {
    const char* name;
    const char* file;  ///< of the data folder; "" for a sample of that name
    int size;          ///< of a sample
};
constexpr Subject cornell{"cornell", "", 128}, head_256{"head-256", "head_unc.nii.gz", 0},
    cthead{"cthead", "cthead.nrrd", 0}, brain{"brain", "brain_mri.nii.gz", 0},
    head_512{"head-512", "head_ct_512.nrrd", 0};

/// Nothing where the data is missing. Quick: the middle of a sample, small.
std::optional<Volume> volume_of(const Setup& setup, const Subject& subject) {
    if (!*subject.file) return make_sample(subject.name, setup.quick ? 32 : subject.size);
    const auto file = real_file(setup.data, subject.file);
    if (!file) return std::nullopt;
    return read_volume(file->string(), {}, setup.progress);
}

Row one(const std::string& name, const std::string& unit, double value, const std::string& note = {}) {
    return {name, unit, {value, value, value, 1}, {}, {}, note};
}

/// CPU seconds of one path for all cells, from some of them: runs of sixteen cells, or blocks.
double scaled_seconds(const Setup& setup, const HistogramData& data, HistogramPath path, std::size_t units) {
    const auto source = make_source(Device::cpu(1, setup.device.isa), data, path);
    const BlockMap blocks(data.cells.grid.count);
    std::mt19937 random(3);
    std::size_t cells = 0;
    const double seconds = cpu_seconds([&] {
        for (std::size_t i = 0; i < units; ++i) {
            const std::size_t block = random() % blocks.holds.size();
            const auto [x, y, z] = blocks.cells(block, data.cells.grid.count);
            const int row_y = y.first + int(random() % unsigned(y.second - y.first)), row_z = z.first;
            const auto count = std::size_t(x.second - x.first);
            const bool whole = path == HistogramPath::fast;
            source->find(
                block, 1, [&](int j, int k) { return whole || (j == row_y && k == row_z); },
                [&](int, int, const PackedHistogram*) { cells += count; });
        }
    });
    return seconds / double(std::max<std::size_t>(cells, 1)) * double(data.cells.grid.size());
}

HistogramData data_of(const DeviceVolume& volume, const HistogramSettings& settings, Progress& progress) {
    HistogramData data{bin_cells(volume.data().device, volume.data(), progress), {}, settings.radius};
    data.packing = make_packing(settings.packing, settings.packed_bins, data.cells.counts());
    return data;
}

/// A row of the published Table 1: brute force and moving ball scaled from a part, then the whole as it is.
std::vector<Row> measure_preprocessing(const Setup& setup, const std::string& name, const Subject& subject,
                                       HistogramSettings settings) {
    const auto volume = volume_of(setup, subject);
    if (!volume) return {{name + "/whole", "CPU s", {}, {}, {}, no_data}};
    if (setup.quick) settings.radius = 4, settings.clusters = 64;
    const DeviceVolume voxels = upload(setup.device, *volume);
    const HistogramData data = data_of(voxels, settings, setup.progress);
    const std::size_t rows = setup.quick ? 2 : 12;
    const double exact = scaled_seconds(setup, data, HistogramPath::exact, rows),
                 sweep = scaled_seconds(setup, data, HistogramPath::sweep, rows),
                 fast = scaled_seconds(setup, data, HistogramPath::fast, setup.quick ? 2 : 6);
    const std::string part = "scaled from a random part";
    std::vector<Row> found{one(name + "/exact", "CPU s", exact, part), one(name + "/sweep", "CPU s", sweep, part)};
    found.push_back({name + "/fast", "CPU s", {fast, fast, fast, 1}, exact / fast, "times faster than exact", part});
    StageTimer timer;
    LocalHistograms h;
    const double seconds =
        cpu_seconds([&] { h = find_local_histograms(setup.device, voxels.data(), settings, timer, setup.progress); });
    found.push_back(one(name + "/whole", "CPU s", seconds,
                        fmt::format("{} words, {} packed bins", h.codewords, data.packing.packed)));
    double wall = 0;
    const auto stages = timer.take();
    for (const Stage& stage : stages) wall += stage.seconds;
    for (const Stage& stage : stages)
        found.push_back(one(fmt::format("{}/{}", name, stage.name), "CPU s", seconds * stage.seconds / wall,
                            "the stage's share of the time"));
    const double before = 2.0 * double(h.node_count()) * data.cells.binning.count * 4;
    found.push_back(one(name + "/size", "MiB", double(h.bytes() - h.displaced.size()) / (1 << 20),
                        fmt::format("as full histograms of floats {:.0f} MiB", before / (1 << 20))));
    return found;
}

/// Vector kernels against the scalar build of the same source.
std::vector<Row> measure_exact(const Setup& setup, const std::string& name) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", setup.quick ? 32 : 128));
    HistogramSettings settings{.radius = setup.quick ? 4 : 16};
    const HistogramData data = data_of(volume, settings, setup.progress);
    const Ball ball(settings.radius, true);
    const auto run = [&](Isa isa) {
        const ExactHistograms exact(Device::cpu(1, isa), data.cells, ball, data.packing.low, data.packing.packed);
        std::vector<float> histograms(std::size_t(2 * data.packing.packed));
        const auto n = unsigned(data.cells.grid.count[0]);
        constexpr int cells = 400;
        std::mt19937 random(5);
        return 1e6 / cells * cpu_seconds([&] {
                   for (int i = 0; i < cells; ++i) {
                       const int x = int(random() % n), y = int(random() % n), z = int(random() % n);
                       exact.find(x, y, z, histograms.data());
                   }
               });
    };
    const auto series = in_turns(setup.runs, {[&] { return run(Isa::scalar); }, [&] { return run(setup.device.isa); }});
    return {{name, "µs a cell", spread_of(series[1]), median_ratio(series[0], series[1]), "times the scalar build"}};
}

/// The table that an edit renews: 2048 words of 4096 bins.
std::vector<Row> measure_table(const Setup& setup, const std::string& name) {
    const RandomCodewords codewords(setup);
    VoxelBuffer from(codewords.bytes()), to(from.size());
    std::fill_n(from.data(), from.size(), std::byte{1});
    const auto series = in_turns(
        setup.runs, {[&] { return 1e3 * cpu_seconds([&] { codewords.sum(setup.device); }); },
                     [&] { return 1e3 * cpu_seconds([&] { std::copy_n(from.data(), from.size(), to.data()); }); },
                     [&] { return 1e3 * wall_seconds([&] { codewords.sum(setup.device); }); }});
    return {{name, "CPU ms", spread_of(series[0]), median_ratio(series[0], series[1]), "memcpy of the words",
             fmt::format("{} words × 4096 bins; the threads share it: {:.2f} ms of wall",
                         codewords.histograms->codewords, spread_of(series[2]).median)}};
}

std::vector<Row> measure_error(const Setup& setup, const std::string& name, const Subject& subject,
                               HistogramSettings settings) {
    const auto volume = volume_of(setup, subject);
    if (!volume) return {{name, "RMSE", {}, {}, {}, no_data}};
    if (setup.quick) settings.radius = 4, settings.clusters = std::min(settings.clusters, 64);
    const Statistics statistics = measure(*volume);
    const DeviceVolume voxels = upload(setup.device, *volume);
    StageTimer timer;
    const LocalHistograms h = find_local_histograms(setup.device, voxels.data(), settings, timer, setup.progress);
    auto functions = four_functions(statistics.min, statistics.p999);
    if (!*subject.file) functions = {{"own", sample_transfer_function(subject.name)}};
    const auto errors = occlusion_errors(voxels, h, functions, setup.quick ? 50 : 2000);
    std::string note;
    double squares = 0;
    for (std::size_t f = 0; f < errors.size(); ++f) {
        note += fmt::format("{}{} {:.4f}", f ? ", " : "", functions[f].first, errors[f].rmse);
        squares += errors[f].rmse * errors[f].rmse / double(errors.size());
    }
    return {one(name, "RMSE", std::sqrt(squares), note)};
}

void add_errors(const Setup& setup, const Subject& subject, const HistogramSettings& base, std::vector<Case>& cases) {
    const auto add = [&](const std::string& what, const HistogramSettings& settings) {
        const std::string name = fmt::format("histogram/error/{}/{}", subject.name, what);
        cases.push_back(
            {{name}, [&setup, name, subject, settings] { return measure_error(setup, name, subject, settings); }});
    };
    for (const int clusters : {256, 512, 1024, 2048, 4096}) {
        HistogramSettings s = base;
        s.clusters = clusters;
        add(fmt::format("clusters-{}", clusters), s);
    }
    for (const auto metric : {HistogramMetric::l1, HistogramMetric::lmax}) {
        HistogramSettings s = base;
        s.metric = metric;
        add("metric-" + to_text(metric), s);
    }
    for (const auto packing : {HistogramPacking::paper, HistogramPacking::cumulative}) {
        HistogramSettings s = base;
        s.packing = packing;
        add("packing-" + to_text(packing), s);
    }
}

}  // namespace

std::vector<Case> histogram_cases(const Setup& setup) {
    std::vector<Case> cases;
    cases.push_back({{"histogram/table"}, [&setup] { return measure_table(setup, "histogram/table"); }});
    cases.push_back({{"histogram/exact"}, [&setup] { return measure_exact(setup, "histogram/exact"); }});
    const auto add = [&](const Subject& subject, int radius, int clusters, int bins) {
        const std::string name = fmt::format("histogram/{}/r{}-{}", subject.name, radius, clusters);
        const HistogramSettings settings{.radius = radius, .clusters = clusters, .packed_bins = bins};
        cases.push_back(
            {{name + "/whole", name + "/exact", name + "/sweep", name + "/fast"},
             [&setup, name, subject, settings] { return measure_preprocessing(setup, name, subject, settings); }});
    };
    for (const int clusters : {256, 512, 1024}) add(cornell, 32, clusters, 16);
    for (const int radius : {12, 16, 24}) add(head_256, radius, 2048, 64);
    add(brain, 24, 2048, 64);
    add(head_512, 32, 2048, 64);
    add_errors(setup, cornell, {.radius = 16}, cases);
    add_errors(setup, head_256, {}, cases);
    add_errors(setup, cthead, {}, cases);
    return cases;
}

}  // namespace chiaro::bench
