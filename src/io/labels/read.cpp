// From a volume of numbers to labels with names.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "core/text.h"
#include "core/threads.h"
#include "io/labels/numbered.h"
#include "io/labels/table.h"

namespace chiaro {
namespace {

Label unnamed(std::uint32_t value) {
    if (value == 0) return {.value = 0, .name = "background", .tint = 0};
    return {.value = value, .name = fmt::format("label {}", value), .rgb = label_color(value)};
}

const Label* find(const std::vector<Label>& labels, std::uint32_t value) {
    const auto at = std::lower_bound(labels.begin(), labels.end(), value,
                                     [](const Label& label, std::uint32_t v) { return label.value < v; });
    return at != labels.end() && at->value == value ? &*at : nullptr;
}

void name_labels(const std::vector<std::uint32_t>& values, const LabelTable* table, LabelVolume& made) {
    std::size_t named = 0;
    for (const std::uint32_t value : values) {
        const Label* known = table ? find(table->labels, value) : nullptr;
        made.labels.push_back(known ? *known : unnamed(value));
        if (made.labels.back().name.empty()) made.labels.back().name = unnamed(value).name;
        named += known && value != 0;
    }
    if (!table) return;
    made.notes.insert(made.notes.end(), table->notes.begin(), table->notes.end());
    if (named + 1 < values.size())
        made.notes.push_back(
            fmt::format("{} of {} labels have no name in the table", values.size() - 1 - named, values.size() - 1));
}

void count_labels(LabelVolume& made) {
    std::vector<std::atomic<std::uint64_t>> counts(made.labels.size());
    const auto numbers = made.numbers();
    parallel_for(std::int64_t(numbers.size()), 1 << 20, [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t i = first; i < last;) {
            const std::int64_t begin = i;
            while (i < last && numbers[std::size_t(i)] == numbers[std::size_t(begin)]) ++i;
            counts[numbers[std::size_t(begin)]] += std::uint64_t(i - begin);
        }
    });
    made.counts.assign(counts.begin(), counts.end());
}

/// Segments in layers, laid over each other in the order of the list: the value of each is its place in the list.
Volume laid_over(const Volume& layers, const std::vector<Segment>& segments, LabelTable& table) {
    Volume one = make_volume(layers.dimensions, VoxelType::u16);
    one.geometry = layers.geometry, one.source = layers.source;
    std::vector<Numbered> numbers;
    for (int layer = 0; layer < layers.components; ++layer) numbers.push_back(numbered(layers, layer));
    const auto out = one.as<std::uint16_t>();
    std::uint64_t overlapping = 0;
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const auto& [label, layer] = segments[s];
        if (layer >= layers.components)
            throw Error(ErrorCode::input, fmt::format("{}: a segment is in layer {}, and there are {}",
                                                      one_line(layers.source), layer, layers.components));
        table.labels.push_back(label), table.labels.back().value = std::uint32_t(s + 1);
        const std::vector<std::uint32_t>& values = numbers[std::size_t(layer)].values;
        const auto at = std::find(values.begin(), values.end(), label.value);
        if (label.value == 0 || at == values.end()) continue;
        const auto wanted = std::uint16_t(at - values.begin());
        const auto* const in = reinterpret_cast<const std::uint16_t*>(numbers[std::size_t(layer)].numbers.data());
        std::atomic<std::uint64_t> covered{0};
        parallel_for(std::int64_t(out.size()), 1 << 20, [&](std::int64_t first, std::int64_t last) {
            std::uint64_t here = 0;
            for (auto i = std::size_t(first); i < std::size_t(last); ++i)
                if (in[i] == wanted) here += out[i] != 0, out[i] = std::uint16_t(s + 1);
            covered += here;
        });
        overlapping += covered;
    }
    table.notes.push_back(fmt::format(
        "its segments lie in {} layers: their labels are 1 to {}, in the order of the list{}", layers.components,
        segments.size(),
        overlapping ? fmt::format("; in {} voxels segments overlap, and the last listed one is shown", overlapping)
                    : ""));
    return one;
}

LabelVolume labels_of_segments(const Volume& volume, const LabelTable* stated, Progress& progress) {
    LabelTable table{.labels = {}, .format = "3D Slicer segmentation", .notes = {}};
    const std::vector<Segment> segments = segments_of(volume.key_values, volume.source);
    if (volume.components > 1) {
        const Volume one = laid_over(volume, segments, table);
        return make_labels(one, stated ? stated : &table, progress);
    }
    for (const Segment& segment : segments)
        if (!find(table.labels, segment.label.value)) table.labels.push_back(segment.label);
    std::sort(table.labels.begin(), table.labels.end(), [](auto& a, auto& b) { return a.value < b.value; });
    return make_labels(volume, stated ? stated : &table, progress);
}

}  // namespace

LabelVolume make_labels(const Volume& volume, const LabelTable* table, Progress& progress) {
    if (volume.components != 1)
        throw Error(ErrorCode::input, fmt::format("{}: holds {} values a voxel: labels are one",
                                                  one_line(volume.source), volume.components));
    LabelVolume made;
    made.dimensions = volume.dimensions, made.geometry = volume.geometry, made.source = volume.source;
    progress.report("labels", 0);
    Numbered found = numbered(volume, 0);
    progress.check();
    made.voxels = std::move(found.numbers);
    name_labels(found.values, table, made);
    count_labels(made);
    progress.check();
    progress.report("labels", 1);
    return made;
}

LabelVolume read_labels(const std::string& name, const std::string& table, const ReadOptions& options,
                        Progress& progress) {
    LabelTable stated;
    if (!table.empty()) stated = read_label_table(table);
    const LabelTable* given = table.empty() ? nullptr : &stated;
    const Volume volume = read_volume(name, options, progress);
    const bool has_segments = !segments_of(volume.key_values, volume.source).empty();
    LabelVolume made =
        has_segments ? labels_of_segments(volume, given, progress) : make_labels(volume, given, progress);
    made.source = name;
    return made;
}

}  // namespace chiaro
