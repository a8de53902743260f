// The stages before the ray caster, against a copy of the volume's bytes.
#include <chiaro/medium.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <cstring>

#include "classify/segments.h"
#include "rows.h"
#include "volume/splined.h"

namespace chiaro::bench {
namespace {

/// The sample `shells`, its values times 257 in 16 bits.
Volume make_shells(int size, VoxelType type) {
    Volume shells = make_sample("shells", size);
    if (type == VoxelType::u8) return shells;
    Volume wide = make_volume(shells.dimensions, type);
    const auto from = shells.as<std::uint8_t>();
    const auto to = wide.as<std::uint16_t>();
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = std::uint16_t(from[i] * 257);
    return wide;
}

std::vector<Row> measure_upload(const Setup& setup, const std::string& name, int size, VoxelType type) {
    const Volume volume = make_shells(size, type);
    VoxelBuffer copy(volume.voxels.size());
    const auto series = in_turns(
        setup.runs,
        {[&] { return 1e3 * cpu_seconds([&] { upload(setup.device, volume); }); },
         [&] { return 1e3 * cpu_seconds([&] { std::memcpy(copy.data(), volume.voxels.data(), copy.size()); }); }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "memcpy of the volume"}};
}

/// A spline's coefficients and the ranges of its cells.
std::vector<Row> measure_splines(const Setup& setup, const std::string& name, int size, VoxelType type) {
    const Volume volume = make_shells(size, type);
    VoxelBuffer copy(volume.voxels.size());
    const auto make = [&] {
        const DeviceVolume fresh = upload(setup.device, volume);  // which keeps what was made of it
        return 1e3 * cpu_seconds([&] { splined(fresh, true); });
    };
    const auto series = in_turns(
        setup.runs, {make, [&] {
                         return 1e3 * cpu_seconds([&] { std::memcpy(copy.data(), volume.voxels.data(), copy.size()); });
                     }});
    return {{name, "ms", spread_of(series[0]), median_ratio(series[0], series[1]), "memcpy of the volume"}};
}

std::vector<Row> measure_classify(const Setup& setup, const std::string& name, int size) {
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    const TransferFunction tf = sample_transfer_function("shells");
    const auto series =
        in_turns(setup.runs, {[&] { return 1e3 * cpu_seconds([&] { classify(volume, tf, Shape{}); }); }});
    return {{name, "ms", spread_of(series[0])}};
}

/// The table for one step length, as each pre-integrated frame makes it; on the clock, for a frame waits for it.
std::vector<Row> measure_segments(const Setup& setup, const std::string& name, VoxelType type) {
    const DeviceVolume volume = upload(setup.device, make_shells(64, type));
    TransferFunction tf = sample_transfer_function("shells");
    if (type != VoxelType::u8)
        for (ControlPoint& point : tf.points) point.value *= 257;
    const Medium medium = classify(volume, tf, Shape{});
    const auto make = [&] { make_segment_table(volume.data(), medium.data().table, 1, setup.device.threads); };
    return {{name, "ms", spread_of(in_turns(setup.runs, {[&] { return 1e3 * wall_seconds(make); }})[0])}};
}

}  // namespace

std::vector<Case> pipeline_cases(const Setup& setup) {
    const int size = setup.quick ? 128 : 512;
    std::vector<Case> cases;
    for (const VoxelType type : {VoxelType::u8, VoxelType::u16}) {
        const std::string name = fmt::format("pipeline/upload/{}", type == VoxelType::u8 ? "u8" : "u16");
        cases.push_back({{name}, [=, &setup] { return measure_upload(setup, name, size, type); }});
        const std::string splines = fmt::format("pipeline/splines/{}", type == VoxelType::u8 ? "u8" : "u16");
        cases.push_back({{splines}, [=, &setup] { return measure_splines(setup, splines, size, type); }});
    }
    for (const VoxelType type : {VoxelType::u8, VoxelType::u16}) {
        const std::string name = fmt::format("pipeline/segments/{}", type == VoxelType::u8 ? "u8" : "u16");
        cases.push_back({{name}, [=, &setup] { return measure_segments(setup, name, type); }});
    }
    const std::string name = "pipeline/classify";
    cases.push_back({{name}, [=, &setup] { return measure_classify(setup, name, size); }});
    return cases;
}

}  // namespace chiaro::bench
