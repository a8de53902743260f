// 3D Slicer's .vp: nine lines - interpolation, shade, diffuse, ambient, specular, power, then scalar opacity, gradient
// opacity and colour, each a count and as many numbers: pairs of value and opacity, or value and red, green, blue. The
// count is of numbers, not of points. Opacity belongs to VTK's unit distance, which .vp does not tell: 1 mm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/transfer/slicer.h"

namespace chiaro {
namespace {

const char* const line_names[] = {"interpolation",  "shading on",     "diffuse",          "ambient", "specular",
                                  "specular power", "scalar opacity", "gradient opacity", "colour"};

struct Line {
    const TransferText& text;
    int number;  // from 1 on
    std::vector<double> values;

    [[noreturn]] void fail(const std::string& what) const {
        text.fail(fmt::format("line {} ({}) {}", number, line_names[number - 1], what));
    }
    double single() const {
        if (values.size() != 1) fail(fmt::format("has {} numbers: must have 1", values.size()));
        return values[0];
    }
    /// The numbers behind the count, a node of N + 1 numbers each.
    template <std::size_t N>
    Curve<N> curve() const {
        if (values.empty()) fail("is empty: must have a count and as many numbers");
        const std::size_t count = values.size() - 1;
        if (values[0] != double(count))
            fail(fmt::format("says {} numbers and has {}: the count is of numbers, not of points", values[0], count));
        if (count == 0 || count % (N + 1) != 0)
            fail(fmt::format("has {} numbers: must have a multiple of {}, and at least one point", count, N + 1));
        if (count / (N + 1) > max_transfer_points)
            fail(fmt::format("has {} points: must have 1..{}", count / (N + 1), max_transfer_points));
        Curve<N> nodes;
        for (std::size_t i = 1; i <= count; i += N + 1) {
            CurveNode<N> node{position(text, at(i), values[i]), {}};
            for (std::size_t c = 0; c < N; ++c) node.y[c] = in_range(text, at(i + 1 + c), values[i + 1 + c], 0, 1);
            nodes.push_back(node);
        }
        std::stable_sort(nodes.begin(), nodes.end(), [](auto& a, auto& b) { return a.x < b.x; });
        return nodes;
    }

private:
    std::string at(std::size_t i) const {
        return fmt::format("line {} ({}) number {}", number, line_names[number - 1], i);
    }
};

Line read_line(const TransferText& text, int number, std::string_view words) {
    Line line{text, number, {}};
    constexpr std::string_view blanks = " \t\r";
    while (true) {
        words.remove_prefix(std::min(words.find_first_not_of(blanks), words.size()));
        if (words.empty()) return line;
        const std::string_view word = words.substr(0, words.find_first_of(blanks));
        double value = 0;
        if (!parse_number(word, value))
            line.fail(fmt::format("has '{}': must be numbers", printable(std::string(word))));
        line.values.push_back(value);
        words.remove_prefix(word.size());
    }
}

std::vector<Line> read_lines(const TransferText& text) {
    constexpr int wanted = 9;
    std::vector<Line> lines;
    std::string_view rest = text.text;
    while (!rest.empty() && int(lines.size()) < wanted) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        lines.push_back(read_line(text, int(lines.size()) + 1, line));
    }
    if (int(lines.size()) < wanted)
        text.fail(fmt::format("ends after {} lines: must have {}, the last of them colour", lines.size(), wanted));
    if (rest.find_first_not_of(" \t\r\n") != rest.npos)
        text.fail(fmt::format("goes on after line {}, which must be the last", wanted));
    return lines;
}

}  // namespace

FoundFunction slicer_function(const ColorCurve& color, const OpacityCurve& opacity, double unit_mm) {
    FoundFunction found;
    found.function.points = united(color, opacity);
    found.function.opacity_unit = unit_mm;
    found.function.opacity_unit_is_mm = true;
    return found;
}

std::string note_on_shading(const SlicerShading& s) {
    return fmt::format(
        "its shading is no part of a transfer function: --ambient {} --diffuse {} --specular {} "
        "--shininess {} gives it",
        s.ambient, s.diffuse, s.specular, s.power);
}

void take_gradient_opacity(const OpacityCurve& gradient, FoundFunction& found) {
    if (std::all_of(gradient.begin(), gradient.end(), [](auto& node) { return node.y[0] == 1; })) return;
    // No gradient is below 0, where curves may begin.
    for (std::size_t i = 0; i < gradient.size(); ++i) {
        const CurveNode<1>& node = gradient[i];
        const bool is_last = i + 1 == gradient.size();
        if (node.x < 0 && !is_last && gradient[i + 1].x <= 0) continue;
        const double share = node.x < 0 && !is_last ? -node.x / (gradient[i + 1].x - node.x) : 0;
        found.function.gradient.push_back(
            {std::max(node.x, 0.0), is_last ? node.y[0] : std::lerp(node.y[0], gradient[i + 1].y[0], share)});
    }
}

FoundFunction read_slicer_lines(const TransferText& text, const Statistics&) {
    const std::vector<Line> lines = read_lines(text);
    const double interpolation = lines[0].single();
    const bool shaded = lines[1].single() != 0;
    const SlicerShading shading{lines[3].single(), lines[2].single(), lines[4].single(), lines[5].single()};
    const OpacityCurve opacity = lines[6].curve<1>(), gradient = lines[7].curve<1>();
    FoundFunction found = slicer_function(lines[8].curve<3>(), opacity, 1);
    if (shaded) found.notes.push_back(note_on_shading(shading));
    if (interpolation == 0) found.notes.push_back("its volume without interpolation is shown interpolated");
    take_gradient_opacity(gradient, found);
    if (text.text.find_last_of(" \t\r\n") != text.text.size() - 1)
        found.notes.push_back("no line end follows its last number: it may be cut, and the file with it");
    return found;
}

}  // namespace chiaro
