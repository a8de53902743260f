#include "edits.h"

#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int times = 20;

}  // namespace

TransferFunction edited(const TransferFunction& tf, int i) {
    std::mt19937 random{std::uint32_t(i)};
    const auto real = [&](double low, double high) { return low + (high - low) * double(random()) / 0x1p32; };
    TransferFunction changed = tf;
    const double span = tf.points.back().value - tf.points.front().value;
    switch (i % 3) {
        case 0: {
            ControlPoint& point = changed.points[random() % changed.points.size()];
            point.opacity = std::clamp(point.opacity * real(0.5, 1.5) + 1e-4, 0.0, 1.0);
            return changed;
        }
        case 1: {
            const double shift = real(-0.05, 0.05) * span;
            for (ControlPoint& point : changed.points) point.value += shift;
            return changed;
        }
        default:
            for (ControlPoint& point : changed.points) point.opacity = std::min(point.opacity * real(0.3, 2), 1.0);
            return changed;
    }
}

std::optional<EditedVolume> edited_volume(const Setup& setup, const std::string& name, int size) {
    if (name == "head_ct_512") {
        const auto file = real_file(setup.data, "head_ct_512.nrrd");
        if (!file) return {};
        const Volume volume = read_volume(file->string(), {}, setup.progress);
        return EditedVolume{upload(setup.device, volume), preset("ct-bone", measure(volume))};
    }
    return EditedVolume{
        upload(setup.device, make_sample("shells", size)),
        name == "fog" ? scene_function(fmt::format("shells{}-fog", size)).value() : sample_transfer_function("shells")};
}

std::vector<Row> measure_edits(const std::string& row, const EditedVolume& subject,
                               const std::function<void(const Medium&)>& light) {
    Series wall, cpu;
    for (int i = -1; i < times; ++i) {
        const TransferFunction tf = edited(subject.tf, i + 1);
        const Clock wall_clock = Clock::wall(), cpu_clock = Clock::cpu();
        light(classify(subject.volume, tf, Shape{}));
        if (i < 0) continue;  // a warm-up
        wall.push_back(wall_clock.ms()), cpu.push_back(cpu_clock.ms());
    }
    return {{row,
             "wall ms",
             spread_of(wall),
             {},
             {},
             fmt::format("the worst of {} edits beside the median; {:.0f} core-ms", times, spread_of(cpu).median)}};
}

}  // namespace chiaro::bench
