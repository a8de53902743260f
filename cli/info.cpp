// chiaro info: what a volume is and what its values mean.
#include <chiaro/error.h>
#include <chiaro/labels.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "command.h"
#include "core/text.h"
#include "job.h"
#include "json.h"
#include "paging_options.h"
#include "setting_flags.h"
#include "stats.h"

namespace chiaro::cli {
namespace {

struct InfoOptions {
    std::string volume;
    bool json = false;
    std::string labels, label_table;
    PagingOptions paging;
    SettingFlags flags;
    CommonOptions common;
};

/// One of several values of a voxel.
struct ChannelRange {
    ComponentInfo info;
    double min = 0, max = 0;  ///< infinite where no voxel has a value
};

std::vector<ChannelRange> ranges_of_channels(const Volume& volume) {
    if (volume.components < 2) return {};
    std::vector<ChannelRange> ranges;
    const auto count = std::size_t(volume.components);
    for (std::size_t c = 0; c < count; ++c) {
        constexpr double none = std::numeric_limits<double>::infinity();
        ChannelRange& range = ranges.emplace_back(ChannelRange{{}, none, -none});
        if (!volume.component_infos.empty()) range.info = volume.component_infos[c];
        with_voxel_type(volume.type, [&](auto voxel) {
            const auto values = volume.as<decltype(voxel)>();
            for (std::size_t i = c; i < values.size(); i += count)
                if (const double v = volume.slope * double(values[i]) + volume.intercept; std::isfinite(v))
                    range.min = std::min(range.min, v), range.max = std::max(range.max, v);
        });
    }
    return ranges;
}

constexpr double worth_leaving_out = 0.005;  // of the dense matter: more than specks

/// What is told of a volume: by all of its voxels, or by those of a coarse level.
struct Told {
    const Volume& volume;   ///< of a volume by bricks without its voxels
    const Volume& sampled;  ///< whose voxels were measured
    const BrickSource* source;
    Statistics statistics = measure(sampled);
    Guess guess = chiaro::guess(sampled, statistics);
    double detached = detached_share(sampled, statistics);
    std::vector<ChannelRange> channels = ranges_of_channels(sampled);
    std::optional<LabelVolume> labels = {};
};

double mm3_of_voxel(const Geometry& g) {
    const auto& [x, y, z] = g.direction;
    return g.spacing_mm.x * g.spacing_mm.y * g.spacing_mm.z * std::abs(dot(x, cross(y, z)));
}

OrderedJson json_of(const LabelVolume& labels) {
    OrderedJson list = OrderedJson::array();
    for (std::size_t i = 0; i < labels.labels.size(); ++i) {
        const Label& label = labels.labels[i];
        list.push_back({{"value", label.value},
                        {"name", label.name},
                        {"rgb", label.rgb},
                        {"tint", label.tint},
                        {"opacity", label.opacity},
                        {"show", label.show},
                        {"voxels", labels.counts[i]},
                        {"mm3", double(labels.counts[i]) * mm3_of_voxel(labels.geometry)}});
    }
    return list;
}

void print_labels(const LabelVolume& labels) {
    const double ml = mm3_of_voxel(labels.geometry) / 1000;
    fmt::print("  labels      {} in {}, {} voxels\n", labels.labels.size() - 1, one_line(labels.source, 4000),
               to_text(labels.dimensions));
    for (std::size_t i = 1; i < labels.labels.size(); ++i) {
        const Label& label = labels.labels[i];
        const auto part = [&](int c) { return int(std::lround(255 * label.rgb[std::size_t(c)])); };
        fmt::print("    {:>8}  #{:02x}{:02x}{:02x}  {:>12} voxels  {:>10.4g} ml  {}{}\n", label.value, part(0), part(1),
                   part(2), labels.counts[i], double(labels.counts[i]) * ml, label.name,
                   label.show ? "" : " (not shown)");
    }
    for (const auto& note : labels.notes) fmt::print("  note        {}\n", one_line(note, 4000));
}

void print_channels(const Told& told) {
    fmt::print("  channels    {}{}\n", told.channels.size(),
               told.volume.has_own_colors ? ", shown in their own colours (--channels-as)" : "");
    for (std::size_t c = 0; c < told.channels.size(); ++c) {
        const auto& [info, min, max] = told.channels[c];
        const auto part = [&](std::size_t i) { return int(std::lround(255 * (*info.rgb)[i])); };
        const std::string color =
            info.rgb ? fmt::format("  #{:02x}{:02x}{:02x}", part(0), part(1), part(2)) : std::string();
        fmt::print("    {}: {:.6g} to {:.6g}{}  {}\n", c + 1, min, max, color, one_line(info.name, 200));
    }
}

void print_json(const Told& told) {
    OrderedJson info = info_of(told.volume, told.statistics, told.guess);
    for (const auto& [channel, min, max] : told.channels) {
        OrderedJson one{{"name", channel.name}, {"range", {min, max}}};
        if (channel.rgb) one["rgb"] = *channel.rgb;
        info["channels"].push_back(std::move(one));
    }
    if (told.labels) info["labels"] = json_of(*told.labels), info["label_notes"] = told.labels->notes;
    info["suggests"] = Json::array();
    if (told.detached >= worth_leaving_out) info["suggests"].push_back("--largest");
    info["statistics"] = told.source ? "sampled" : "exact";
    if (told.source)
        for (const SourceLevel& level : told.source->levels()) {
            const Vec3& spacing = level.geometry.spacing_mm;
            info["levels"].push_back(
                {{"dimensions", level.dimensions}, {"spacing_mm", {spacing.x, spacing.y, spacing.z}}});
        }
    fmt::print("{}\n", printable_json(info.dump(2, ' ', false, Json::error_handler_t::replace)));
}

/// Counts as a line of 64 blocks, on a logarithmic scale: one bin of air would flatten all others.
std::string drawing(const std::array<std::uint64_t, 256>& counts) {
    constexpr std::string_view blocks[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    std::array<double, 64> heights{};
    for (std::size_t i = 0; i < counts.size(); ++i) heights[i / 4] += double(counts[i]);
    for (double& height : heights) height = std::log1p(height);
    const double highest = std::max(1e-9, *std::max_element(heights.begin(), heights.end()));
    std::string line;
    for (double height : heights) line += blocks[std::size_t(std::ceil(8 * height / highest))];
    return line;
}

void print_geometry(const Volume& volume) {
    const Geometry& g = volume.geometry;
    const auto& n = volume.dimensions;
    fmt::print("  spacing     {:.6g} x {:.6g} x {:.6g} mm\n", g.spacing_mm.x, g.spacing_mm.y, g.spacing_mm.z);
    fmt::print("  extent      {:.6g} x {:.6g} x {:.6g} mm\n", n[0] * g.spacing_mm.x, n[1] * g.spacing_mm.y,
               n[2] * g.spacing_mm.z);
    fmt::print("  origin      {:.6g}, {:.6g}, {:.6g} mm\n", g.origin_mm.x, g.origin_mm.y, g.origin_mm.z);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3& d = g.direction[std::size_t(axis)];
        fmt::print("  {} runs      {:.6g}, {:.6g}, {:.6g}\n", "xyz"[axis], d.x, d.y, d.z);
    }
    fmt::print("  world       {}\n", name_of(g.world));
}

/// All moments, as many to a line as there is room for.
void print_moments(const Moments& moments) {
    fmt::print("  moments     {}, of which this is {}{}\n", moments.count, moments.shown,
               moments.times.empty() ? "; when they were taken is not told" : "");
    std::string line;
    for (std::size_t i = 0; i < moments.times.size(); ++i) {
        const std::string number = fmt::format("{:.6g}", moments.times[i]);
        const bool is_file = moments.unit == "file";
        const std::string when = fmt::format("{}: {}{}{}", i, is_file ? "file " : "", number,
                                             is_file || moments.unit.empty() ? "" : " " + moments.unit);
        if (line.size() + when.size() > 100) fmt::print("              {}\n", line), line.clear();
        line += (line.empty() ? "" : "   ") + when;
    }
    if (!line.empty()) fmt::print("              {}\n", line);
}

/// So many that values far from 0 are told apart.
int digits_of(const Statistics& s) {
    const double range = s.max - s.min, largest = std::max(std::abs(s.min), std::abs(s.max));
    return range > 0 ? std::clamp(int(std::ceil(std::log10(largest / range))) + 4, 6, 16) : 6;
}

void print_text(const Told& told) {
    const auto& [volume, sampled, source, s, guess, detached, channels, labels] = told;
    const std::string parts = volume.components > 1 ? fmt::format(", {} components", volume.components) : "";
    fmt::print("{}\n  format      {}\n  voxels      {} {}{}\n", one_line(volume.source, 4000), volume.format,
               to_text(volume.dimensions), chiaro::name_of(volume.type), parts);
    print_geometry(volume);
    if (volume.moments.count > 1) print_moments(volume.moments);
    if (source)
        fmt::print("  levels      {}, halved to {}; what follows is of {} voxels of them (--exact: of all)\n",
                   source->levels().size(), to_text(source->levels().back().dimensions), to_text(sampled.dimensions));
    if (!channels.empty()) print_channels(told);
    const int digits = digits_of(s);
    fmt::print("  values      {:.{}g} to {:.{}g}\n", s.min, digits, s.max, digits);
    fmt::print("  percentiles 1 %: {:.{}g}, 50 %: {:.{}g}, 99 %: {:.{}g}, 99.9 %: {:.{}g}\n", s.p1, digits, s.p50,
               digits, s.p99, digits, s.p999, digits);
    fmt::print("  noise       {:.2g} % of the range from 1 to 99.9 %{}\n", 100 * s.noise,
               s.noise > worth_smoothing ? ": --interpolation auto smooths, where thin structures survive" : "");
    if (s.nonfinite) fmt::print("  not finite  {} voxels\n", s.nonfinite);
    fmt::print("  histogram   |{}| (logarithmic)\n", drawing(s.histogram));
    fmt::print("  looks like  {} ({}): --transfer {}\n", guess.modality, guess.reason, guess.preset);
    if (detached >= worth_leaving_out)
        fmt::print(
            "  suggests    --largest: {:.2g} % of what is denser than -500 HU is no part of the largest piece (a "
            "table, "
            "a head rest)\n",
            100 * detached);
    for (const auto& note : volume.notes) fmt::print("  note        {}\n", one_line(note, 4000));
    if (labels) print_labels(*labels);
}

/// Of the file that the options name; with a table alone, of the volume itself.
std::optional<LabelVolume> labels_of(const InfoOptions& o, const Scene& scene, const Volume& header,
                                     Progress& progress) {
    if (o.labels.empty() && o.label_table.empty()) return {};
    ReadOptions options = scene.read;
    options.time = 0;
    LabelVolume labels = read_labels(o.labels.empty() ? o.volume : o.labels, o.label_table, options, progress);
    place_labels(labels, header.dimensions, header.geometry);
    return labels;
}

void run(const InfoOptions& o) {
    if (o.volume.empty()) throw Error(ErrorCode::usage, "VOLUME is missing; see chiaro info --help");
    Scene scene;
    scene.volume = o.volume;
    scene.read.private_addresses = true;
    o.flags.apply(scene);
    Job job(o.common);
    Stats stats;
    const auto source = o.paging.exact ? nullptr : paged_volume(scene, paging_of(o.paging));
    const Volume volume = stats.stage("read", [&] {
        return source ? read_level(*source, small_level(*source), job.progress) : read_volume(scene, job.progress);
    });
    Told told = stats.stage("measure", [&] { return Told{source ? source->header() : volume, volume, source.get()}; });
    told.labels = labels_of(o, scene, told.volume, job.progress);
    job.progress.check();
    job.bar.clear();
    (o.json ? print_json : print_text)(told);
    if (o.common.verbose) tell_stages(stats);
}

}  // namespace

Command info_command(CLI::App& tool) {
    const auto o = std::make_shared<InfoOptions>();
    CLI::App* app = tool.add_subcommand("info", "Tells a volume's geometry, values and notes");
    app->add_option("VOLUME", o->volume,
                    "file, folder of slices, URL of an OME-Zarr, sample:NAME[:SIZE], or - for NRRD on standard input");
    app->add_flag("--json", o->json, "as JSON; the columns of `direction` are the index axes in the world");
    app->add_flag("--exact", o->paging.exact,
                  "reads all voxels, where a volume that does not fit is measured on a coarse level");
    app->add_option("--labels", o->labels, "volume of labels that lie in this one, to be listed")->type_name("VOLUME");
    app->add_option("--label-table", o->label_table,
                    "names of labels: a file, or totalsegmentator; without --labels the volume's own values are labels")
        ->type_name("FILE");
    add_memory_option(*app, o->paging);
    add_common_options(*app, o->common);
    o->flags.add_to(*app, "Volume");
    return {app, [o] { run(*o); }};
}

}  // namespace chiaro::cli
