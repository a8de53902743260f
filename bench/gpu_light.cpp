// Light on a GPU by the clock on the wall: what the papers measured, on shells, and on a head where there is one.
#include <chiaro/io.h>
#include <chiaro/samples.h>

#include "classify/medium.h"
#include "gpu.h"
#include "illumination/access.h"
#include "illumination/visibility/density.h"
#include "illumination/visibility/visibility.h"

namespace chiaro::bench {
namespace {

Medium shells(const Setup& setup, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", setup.quick ? 48 : size));
    return classify(volume, sample_transfer_function("shells"), Shape{});
}

/// Rows by the clock, against one pass over so many bytes.
std::vector<Row> against_pass(const Setup& setup, const std::vector<std::string>& names, std::vector<Measure> measures,
                              std::size_t bytes, const char* of) {
    measures.push_back([&] { return pass_ms(setup, bytes); });
    const auto series = in_turns(setup.runs, measures);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < names.size(); ++i)
        rows.push_back({names[i], "ms", spread_of(series[i]), median_ratio(series[i], series.back()), of});
    return rows;
}

/// All that becomes of a classified volume in the published model; and the share of its levels, where it stores them.
std::vector<Row> measure_spao(const Setup& setup, const std::vector<std::string>& names, SpaoFilter filter) {
    const Medium medium = shells(setup, 512);
    IlluminationSettings settings{.method = Method::spao};
    settings.spao.filter = filter, settings.spao.model = SpaoModel::paper;
    if (filter != SpaoFilter::automatic) settings.spao.levels = 6, settings.spao.normal_factor = 1;
    StageTimer timer;
    std::size_t cells = 0;
    const auto whole = [&] {
        return 1e3 * wall_seconds([&] {
                   const CellOpacity opacity = cell_opacity(medium.data(), setup.progress);
                   cells = opacity.values.grid.size();
                   accessibility(setup.device, medium.data(), opacity, settings,
                                 BlockMap(opacity.values.grid.count, true), timer, setup.progress);
               });
    };
    const auto levels = [&] {  // of the whole before it
        double seconds = 0;
        for (const Stage& stage : timer.take())
            if (stage.name.find("level") != std::string::npos) seconds += stage.seconds;
        return 1e3 * seconds;
    };
    std::vector<Measure> measures{whole};
    if (names.size() > 1) measures.push_back(levels);
    whole();
    timer.take();
    return against_pass(setup, names, measures, 2 * cells, "a pass over 2 bytes a cell");
}

/// 400 directions, 16 coefficients of each node: density and sweep.
std::vector<Row> measure_visibility(const Setup& setup, const std::string& name, int subsample) {
    const Medium medium = shells(setup, 256);
    const VisibilitySettings settings{.directions = 400, .subsample = subsample};
    std::size_t nodes = 0;
    const auto found = [&] {
        StageTimer timer;
        const Density density = density_for(medium.data(), subsample, setup.device, setup.progress);
        nodes = density.grid.size();
        find_visibility(setup.device, density, settings, timer, setup.progress);
    };
    found();
    return against_pass(setup, {name}, {[&] { return 1e3 * wall_seconds(found); }}, nodes * sizeof(float[16]),
                        "a pass over the float32 field");
}

/// Histograms, codebook and identifiers of a head of 256 classes.
std::vector<Row> measure_histograms(const Setup& setup, const std::string& name) {
    const auto file = real_file(setup.data, "head_unc.nii.gz");
    if (!setup.quick && !file) return {{name, "s", {}, {}, {}, no_data}};
    const DeviceVolume volume =
        upload(setup.device, setup.quick ? make_sample("shells", 32) : read_volume(file->string(), {}, setup.progress));
    IlluminationSettings settings{.method = Method::histogram};
    settings.histogram.radius = setup.quick ? 4 : 16, settings.histogram.clusters = setup.quick ? 64 : 2048;
    settings.histogram.packed_bins = 64, settings.histogram.cache = "none";
    const auto found = [&] { return wall_seconds([&] { prepare(volume, settings, setup.progress); }); };
    const auto series = in_turns(setup.runs, {found, [&] { return 1e-3 * pass_ms(setup, volume.bytes()); }});
    return {{name, "s", spread_of(series[0]), median_ratio(series[0], series[1]), "a pass over the voxels"}};
}

/// measure(names), where there is a GPU.
template <class Measured>
Case case_of(const Setup& setup, const std::vector<std::string>& names, const char* unit, const Measured& measure) {
    return {names, [=, &setup] {
                if (setup.device.has_gpu()) return measure(names);
                std::vector<Row> rows;
                for (const auto& name : names) rows.push_back(skipped(name, unit, no_gpu));
                return rows;
            }};
}

}  // namespace

std::vector<Case> gpu_light_cases(const Setup& setup) {
    std::vector<Case> cases;
    const auto add_spao = [&](const std::vector<std::string>& names, SpaoFilter filter) {
        cases.push_back(case_of(setup, names, "ms", [&setup, filter](const std::vector<std::string>& of) {
            return measure_spao(setup, of, filter);
        }));
    };
    add_spao({"gpu/spao/nbuffer/whole", "gpu/spao/nbuffer/levels"}, SpaoFilter::nbuffer);
    add_spao({"gpu/spao/mipmap/whole", "gpu/spao/mipmap/levels"}, SpaoFilter::mipmap);
    add_spao({"gpu/spao/fused/whole"}, SpaoFilter::automatic);
    for (const int subsample : {2, 1}) {
        const std::string name = subsample == 2 ? "gpu/visibility/128" : "gpu/visibility/256";
        cases.push_back(case_of(setup, {name}, "ms", [&setup, subsample](const std::vector<std::string>& names) {
            return measure_visibility(setup, names[0], subsample);
        }));
    }
    cases.push_back(case_of(setup, {"gpu/histogram/prepare"}, "s", [&setup](const std::vector<std::string>& names) {
        return measure_histograms(setup, names[0]);
    }));
    return cases;
}

}  // namespace chiaro::bench
