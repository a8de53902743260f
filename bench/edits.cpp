#include "edits.h"

#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <utility>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr int times = 20;

/// All that the function shows, or one surface whose value lies in the middle half of the function's.
Shape shape_of(const EditedVolume& subject, int i) {
    Shape shape;
    if (!subject.is_surface) return shape;
    std::mt19937 random{std::uint32_t(i)};
    const double first = subject.tf.points.front().value, last = subject.tf.points.back().value;
    shape.mode = Mode::iso;
    shape.iso = {{.value = first + (last - first) * (0.25 + 0.5 * double(random()) / 0x1p32), .color = Rgb{1, 1, 1}}};
    return shape;
}

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

TransferFunction recoloured(const TransferFunction& tf, int i) {
    std::mt19937 random{std::uint32_t(i)};
    TransferFunction changed = tf;
    for (double& channel : changed.points[random() % changed.points.size()].rgb) channel = double(random()) / 0x1p32;
    return changed;
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

std::vector<Row> measure_edits(const std::string& row, const EditedVolume& subject, const LightAfterEdit& light,
                               TransferFunction (*edit)(const TransferFunction&, int)) {
    struct {
        Series wall, cpu;
    } soon, last;
    for (int i = -1; i < times; ++i) {
        const TransferFunction tf = edit(subject.tf, i + 1);
        const Clock wall = Clock::wall(), cpu = Clock::cpu();
        const auto keep = [&](auto& in) { in.wall.push_back(wall.ms()), in.cpu.push_back(cpu.ms()); };
        bool is_soon = i >= 0;  // the first one is a warm-up
        light(classify(subject.volume, tf, shape_of(subject, i + 1)), [&] {
            if (std::exchange(is_soon, false)) keep(soon);
        });
        if (i >= 0) keep(last);
    }
    const auto row_of = [&](const std::string& name, const auto& of) {
        return Row{
            name,
            "wall ms",
            spread_of(of.wall),
            {},
            {},
            fmt::format("the worst of {} edits beside the median; {:.0f} core-ms", times, spread_of(of.cpu).median)};
    };
    if (soon.wall.empty()) return {row_of(row, last)};
    return {row_of(row, last), row_of(row + "/coarse", soon)};
}

std::vector<Row> measure_edits(const Setup& setup, const std::string& row, const std::string& volume, int size,
                               const IlluminationSettings& settings,
                               TransferFunction (*edit)(const TransferFunction&, int)) {
    const std::optional<EditedVolume> subject = edited_volume(setup, volume, size);
    if (!subject) return {{row, "wall ms", {}, {}, {}, no_data}};
    IlluminationField field;
    const auto light = [&](const Medium& medium, const std::function<void()>& soon) {
        const IlluminationField warm = field;
        const auto keep = [&](IlluminationField found) {
            field = std::move(found);
            if (field.is_coarse()) soon();
        };
        illuminate(setup.device, medium, Prepared(), Lighting(), settings, keep, setup.progress, warm);
    };
    return measure_edits(row, *subject, light, edit);
}

}  // namespace chiaro::bench
