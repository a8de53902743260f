// Label tables of a line each, all of words between blanks, with # before comments:
// ITK-SNAP      IDX R G B A VIS MSH "LABEL"   A in [0, 1]; some write 255
// 3D Slicer     IDX NAME R G B A              A of 255; blanks in names are underscores, or the name is quoted
// FreeSurfer    IDX NAME R G B A              A is transparency: 0 is opaque
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "core/text.h"
#include "io/labels/table.h"

namespace chiaro {
namespace {

struct Word {
    std::string text;
    bool quoted = false;
};

class Line {
public:
    Line(const LabelText& text, int number, std::string_view line) : text_(text), number_(number) { split(line); }

    bool empty() const { return words_.empty(); }
    std::size_t size() const { return words_.size(); }
    const Word& operator[](std::size_t i) const { return words_[i]; }

    [[noreturn]] void fail(const std::string& what) const { text_.fail(fmt::format("line {} {}", number_, what)); }

    std::uint32_t value() const {
        std::uint32_t value = 0;
        if (!parse_label_value(words_[0].text, value))
            fail(fmt::format("has the label '{}': must be a whole number from 0 to 4294967295",
                             one_line(words_[0].text, 80)));
        return value;
    }
    std::optional<double> number_at(std::size_t i) const {
        if (i >= words_.size() || words_[i].quoted) return {};
        const std::string& word = words_[i].text;
        double number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (error != std::errc{} || end != word.data() + word.size()) return {};
        return number;
    }
    double number(std::size_t i, const char* what, double highest) const {
        const std::optional<double> number = number_at(i);
        if (!number || !(*number >= 0 && *number <= highest))
            fail(fmt::format("has the {} '{}': must be a number in [0, {}]", what,
                             i < words_.size() ? one_line(words_[i].text, 80) : "", highest));
        return *number;
    }
    Rgb color(std::size_t i) const {
        return {number(i, "red", 255) / 255, number(i + 1, "green", 255) / 255, number(i + 2, "blue", 255) / 255};
    }

private:
    void split(std::string_view line) {
        constexpr std::string_view blanks = " \t\r\v\f";
        while (true) {
            line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
            if (line.empty() || line[0] == '#') return;
            if (line[0] == '"') {
                const std::size_t end = line.find('"', 1);
                if (end == line.npos) fail("begins a name with \" that it does not end");
                words_.push_back({std::string(line.substr(1, end - 1)), true});
                line.remove_prefix(end + 1);
                continue;
            }
            const std::size_t end = std::min(line.find_first_of(blanks), line.size());
            words_.push_back({std::string(line.substr(0, end)), false});
            line.remove_prefix(end);
        }
    }

    const LabelText& text_;
    int number_;
    std::vector<Word> words_;
};

/// ITK-SNAP's, whose names stand last.
Label snap_label(const Line& line) {
    if (line.size() < 8) line.fail(fmt::format("has {} words: must have IDX R G B A VIS MSH and a name", line.size()));
    Label label{.value = line.value(), .name = line[7].text, .rgb = line.color(1)};
    for (std::size_t i = 8; i < line.size(); ++i) label.name += " " + line[i].text;
    const double alpha = line.number(4, "alpha", 255);
    label.tint = alpha > 1 ? alpha / 255 : alpha;
    label.show = line.number(5, "visibility", 1) > 0;
    return label;
}

Label named_label(const Line& line, bool is_slicer) {
    if (line.size() < 5)
        line.fail(fmt::format("has {} words: must have a number, a name, and red, green and blue", line.size()));
    const std::size_t color = line.number_at(line.size() - 1) && line.size() >= 6 && line.number_at(line.size() - 4)
                                  ? line.size() - 4
                                  : line.size() - 3;
    Label label{.value = line.value(), .name = line[1].text, .rgb = line.color(color)};
    for (std::size_t i = 2; i < color; ++i) label.name += " " + line[i].text;
    if (is_slicer && !line[1].quoted) std::replace(label.name.begin(), label.name.end(), '_', ' ');
    if (color + 3 < line.size()) {
        const double alpha = line.number(color + 3, "alpha", 255) / 255;
        label.tint = is_slicer ? alpha : 1 - alpha;
    }
    return label;
}

}  // namespace

LabelTable read_label_lines(const LabelText& text) {
    LabelTable table;
    std::string_view rest = text.text;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    const bool is_slicer = text.ends_with(".ctbl") || text.text.find("Color table file") != text.text.npos;
    std::optional<bool> is_snap;
    for (int number = 1; !rest.empty(); ++number) {
        const std::string_view words = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(words.size() + 1, rest.size()));
        const Line line(text, number, words);
        if (line.empty()) continue;
        if (!is_snap) is_snap = text.ends_with(".label") || (!is_slicer && line.number_at(1) && line.size() >= 8);
        table.labels.push_back(*is_snap ? snap_label(line) : named_label(line, is_slicer));
    }
    if (table.labels.empty()) text.fail("holds no label");
    table.format = *is_snap ? "ITK-SNAP" : is_slicer ? "3D Slicer" : "FreeSurfer";
    return table;
}

}  // namespace chiaro
