#include "illumination/histogram/emission_mapping.h"

#include <chiaro/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/file_contents.h"

namespace chiaro {
namespace {

std::optional<double> number(const std::string& text) {
    std::istringstream in(text);
    double value = 0;
    return in >> value && in.eof() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The text of a file of glow values.
std::string list_in(const std::string& file, const std::string& who) {
    try {
        return file_text(file, 64u << 20);
    } catch (const Error& error) {
        throw Error(ErrorCode::input, who + ": is neither LO:HI=STRENGTH nor a file: " + error.what());
    }
}

}  // namespace

EmissionMapping::EmissionMapping(const std::string& text) {
    const std::string who = "glow '" + text + "'";
    const auto colon = text.find(':'), equals = text.find('=', colon == text.npos ? 0 : colon);
    if (colon != text.npos && equals != text.npos) {
        const auto low = number(text.substr(0, colon)), high = number(text.substr(colon + 1, equals - colon - 1)),
                   strength = number(text.substr(equals + 1));
        if (!low || !high || !strength || *low > *high)
            throw Error(ErrorCode::usage, who + ": expected LO:HI=STRENGTH, LO not above HI");
        if (const std::string fault = fault_of(*low, *strength); !fault.empty())
            throw Error(ErrorCode::usage, who + ": " + fault);
        points_ = {{*low, *strength}, {*high, *strength}};
        return;
    }
    std::istringstream file(list_in(text, who));
    int count = 0;
    for (std::string line; std::getline(file, line);) {
        ++count;
        std::istringstream codewords(line.substr(0, line.find('#')));
        std::string value, strength, rest;
        if (!(codewords >> value)) continue;
        codewords >> strength >> rest;
        const auto v = number(value), s = number(strength);
        const std::string fault = v && s && rest.empty() ? fault_of(*v, *s) : "expected VALUE STRENGTH";
        if (!fault.empty()) throw Error(ErrorCode::input, who + ", line " + std::to_string(count) + ": " + fault);
        points_.emplace_back(*v, *s);
    }
    if (points_.empty()) throw Error(ErrorCode::input, who + ": has no line VALUE STRENGTH");
}

std::string EmissionMapping::fault_of(double value, double strength) const {
    if (strength < 1 || strength > 1e6) return "strength must be 1 (does not glow) to 1000000";
    return points_.empty() || value >= points_.back().first ? "" : "values must not fall";
}

double EmissionMapping::at(double value) const {
    if (points_.empty() || value < points_.front().first || value > points_.back().first) return 1;
    const auto next = std::lower_bound(points_.begin(), points_.end(), value,
                                       [](const auto& point, double v) { return point.first < v; });
    if (next == points_.begin() || next->first == value) return next->second;
    const auto before = std::prev(next);
    const double t = (value - before->first) / (next->first - before->first);
    return before->second + t * (next->second - before->second);
}

}  // namespace chiaro
