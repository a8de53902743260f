#include "io/labels/table.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/did_you_mean.h"
#include "core/file_contents.h"
#include "core/text.h"

namespace chiaro {
namespace {

constexpr std::uintmax_t max_header_bytes = 1 << 20;  // of an NRRD file

std::string lower(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// By value, each once. Background is shown as it is, but for what our own tables say.
void arrange(const LabelText& text, LabelTable& table) {
    if (table.labels.size() > max_labels + 1) text.fail(fmt::format("holds more than {} labels", max_labels + 1));
    std::stable_sort(table.labels.begin(), table.labels.end(), [](auto& a, auto& b) { return a.value < b.value; });
    const auto twice = std::adjacent_find(table.labels.begin(), table.labels.end(),
                                          [](auto& a, auto& b) { return a.value == b.value; });
    if (twice != table.labels.end()) text.fail(fmt::format("states the label {} twice", twice->value));
    for (Label& label : table.labels) {
        label.name = one_line(label.name, 200);
        if (label.value == 0 && table.format != "Chiaro") label.tint = 0, label.show = true;
    }
}

/// The key/values of an NRRD header, `key:=value` each on a line, up to the empty line that ends it.
std::map<std::string, std::string> key_values_of(std::string_view header) {
    std::map<std::string, std::string> found;
    while (!header.empty()) {
        std::string_view line = header.substr(0, header.find('\n'));
        header.remove_prefix(std::min(line.size() + 1, header.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.empty()) break;
        const std::size_t colon = line.find(":=");
        if (colon != line.npos && line[0] != '#') found[std::string(line.substr(0, colon))] = line.substr(colon + 2);
    }
    return found;
}

LabelTable segment_table(const LabelText& text) {
    LabelTable table{.labels = {}, .format = "3D Slicer segmentation", .notes = {}};
    for (Segment& segment : segments_of(key_values_of(text.text), text.name)) {
        if (segment.layer > 0) text.fail("has segments in several layers: it names those of its own voxels only");
        table.labels.push_back(std::move(segment.label));
    }
    if (table.labels.empty()) text.fail("holds no segment");
    return table;
}

}  // namespace

void LabelText::fail(const std::string& what) const { throw Error(ErrorCode::input, name + ": " + one_line(what)); }

bool parse_label_value(std::string_view word, std::uint32_t& value) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc{} && end == word.data() + word.size() && !word.empty();
}

Rgb label_color(std::uint32_t value) {
    constexpr double golden = 0.618033988749895, saturation = 0.55;
    const double turn = 6 * std::fmod(value * golden, 1.0), light = value % 2 ? 0.95 : 0.8;
    Rgb rgb{};
    for (int c = 0; c < 3; ++c) {
        const double away = std::fmod(turn + 4.0 * c + 3, 6.0) - 3;  // from the hue of this channel
        const double share = std::clamp(2 - std::abs(away), 0.0, 1.0);
        rgb[std::size_t(c)] = light * (1 - saturation * (1 - share));
    }
    return rgb;
}

std::vector<Label> with_changes(std::vector<Label> labels, const std::vector<LabelChange>& changes) {
    const auto change = [](Label& label, const LabelChange& to) {
        label.rgb = to.rgb.value_or(label.rgb), label.tint = to.tint.value_or(label.tint);
        label.opacity = to.opacity.value_or(label.opacity), label.show = to.show.value_or(label.show);
    };
    for (const LabelChange& to : changes) {
        if (!to.value) {
            for (Label& label : labels)
                if (label.value != 0) change(label, to);
            continue;
        }
        const auto found =
            std::lower_bound(labels.begin(), labels.end(), *to.value,
                             [](const Label& label, std::uint32_t value) { return label.value < value; });
        if (found != labels.end() && found->value == *to.value) change(*found, to);
    }
    return labels;
}

std::vector<FormatInfo> list_label_formats() {
    return {{"Chiaro", ".json", "ours: value, name, rgb, tint, opacity, show"},
            {"class list", ".json", "names and values, as of nnU-Net"},
            {"3D Slicer segmentation", ".seg.nrrd", "names and colours of its segments"},
            {"3D Slicer", ".ctbl", "colour table"},
            {"ITK-SNAP", ".label", "label descriptions"},
            {"FreeSurfer", ".txt", "colour lookup table"},
            {"TotalSegmentator", "totalsegmentator", "the names of its task total"}};
}

LabelTable parse_label_table(const std::string& text, const std::string& name) {
    const LabelText examined{text, name, lower(name)};
    if (text.size() > max_table_bytes) examined.fail("is larger than 16 MiB, which no label table needs");
    const std::size_t bom = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
    const std::size_t first = text.find_first_not_of(" \t\r\n", bom);
    if (first == text.npos) examined.fail("is empty");
    LabelTable table = text.starts_with("NRRD000")                         ? segment_table(examined)
                       : text[first] == '{' || examined.ends_with(".json") ? read_own_labels(examined)
                                                                           : read_label_lines(examined);
    arrange(examined, table);
    return table;
}

LabelTable read_label_table(const std::string& name) {
    std::error_code none;
    const bool is_there = std::filesystem::exists(name, none);
    if (!is_there && lower(name) == "totalsegmentator") return total_segmentator();
    if (!is_there) {
        const std::vector<std::string> names{"totalsegmentator"};
        const bool is_word = name.find_first_of("/.") == name.npos;
        throw Error(ErrorCode::input, "cannot read '" + one_line(name) + "': no such file" +
                                          (is_word ? did_you_mean(name, names) : did_you_mean_file(name)));
    }
    if (lower(name).ends_with(".nrrd") || lower(name).ends_with(".nhdr"))
        return parse_label_table(file_beginning(name, max_header_bytes), name);
    return parse_label_table(file_text(name, max_table_bytes), name);
}

}  // namespace chiaro
