#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/did_you_mean.h"

namespace chiaro {
namespace {

[[noreturn]] void refuse_text(const std::string& sentence) { throw Error(ErrorCode::usage, sentence); }

std::optional<double> number_in(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

/// Exactly `count` numbers, or the refusal that `expected` tells.
std::vector<double> numbers(std::string_view text, std::size_t count, const char* expected) {
    auto values = numbers_in(text);
    if (values.size() != count) refuse_text(fmt::format("expected {}", expected));
    return values;
}

template <class Integer>
Integer integer(double value, Integer lowest, Integer highest) {
    if (value != std::floor(value)) refuse_text("expected a whole number");
    if (value < double(lowest) || value > double(highest))
        refuse_text(fmt::format("must be {} to {}", lowest, highest));
    return Integer(value);
}

int to_int(double value) { return integer<int>(value, -2147483647, 2147483647); }

std::optional<Vec3> axis_in(std::string_view text) {
    const double sign = text.starts_with('-') ? -1 : 1;
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    if (text.size() != 1 || text[0] < 'x' || text[0] > 'z') return {};
    Vec3 axis;
    axis[text[0] - 'x'] = sign;
    return axis;
}

}  // namespace

std::vector<double> numbers_in(std::string_view text) {
    std::vector<double> values;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find_first_of(",x", begin), text.size());
        const auto value = number_in(text.substr(begin, end - begin));
        if (!value) return {};
        values.push_back(*value);
        begin = end + 1;
    }
    return values;
}

std::string to_text(bool value) { return value ? "true" : "false"; }
std::string to_text(int value) { return fmt::format("{}", value); }
std::string to_text(std::uint64_t value) { return fmt::format("{}", value); }
std::string to_text(const std::string& value) { return value; }
std::string to_text(const Vec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }
std::string to_text(const Rgb& c) { return fmt::format("{},{},{}", c[0], c[1], c[2]); }
std::string to_text(const std::pair<double, double>& p) { return fmt::format("{},{}", p.first, p.second); }
std::string to_text(const std::array<int, 3>& n) { return fmt::format("{}x{}x{}", n[0], n[1], n[2]); }
std::string to_text(const std::array<double, 6>& value) { return fmt::format("{}", fmt::join(value, ",")); }
std::string to_text(const Matrix4& value) { return fmt::format("{}", fmt::join(value, ",")); }
std::string to_text(const ClipPlane& value) { return to_text(value.normal) + "," + to_text(value.d); }

std::string to_text(const IsoSurface& value) {
    std::string text = to_text(value.value);
    if (value.color) text += "," + to_text(*value.color);
    if (value.opacity != 1) text += "@" + to_text(value.opacity);
    return text;
}

std::string to_text(const HistogramEffects& value) {
    std::string text;
    const auto add = [&](bool on, const char* name) {
        if (on) text += (text.empty() ? "" : ",") + std::string(name);
    };
    add(value.ao, "ao"), add(value.bleeding, "bleeding"), add(value.scattering, "scattering"),
        add(value.emission, "glow");
    return text.empty() ? "none" : text;
}
std::string to_text(const ShSampling& value) {
    return value.jittered ? fmt::format("jittered:{}", value.sets) : "fibonacci";
}

std::string to_text(const ProbeExposure& value) { return value.stops ? to_text(*value.stops) : "auto"; }
std::string to_text(const Bounces& value) { return value.most ? to_text(*value.most) : "unlimited"; }

std::string to_text(int width, int height) { return fmt::format("{}x{}", width, height); }
std::string to_text(const Rgb& color, bool transparent, bool) { return transparent ? "transparent" : to_text(color); }
std::string to_text(const Light& value) {
    const std::string color = "," + to_text(value.color);
    if (value.position_mm) return "at:" + to_text(*value.position_mm) + color;
    if (value.headlight) return value.color == Rgb{1, 1, 1} ? "headlight" : "headlight" + color;
    return fmt::format("{},{}{}", value.azimuth_deg, value.elevation_deg, color);
}

void from_text(std::string_view text, bool& value) {
    if (text != "true" && text != "false") refuse_text("expected true or false");
    value = text == "true";
}
void from_text(std::string_view text, int& value) { value = to_int(numbers(text, 1, "a whole number")[0]); }
void from_text(std::string_view text, std::uint64_t& value) {
    // Up to 2^53 a number of JSON is exact.
    value = integer<std::uint64_t>(numbers(text, 1, "a whole number")[0], 0, std::uint64_t(1) << 53);
}
void from_text(std::string_view text, double& value) { value = numbers(text, 1, "a number")[0]; }
void from_text(std::string_view text, std::string& value) { value = text; }
void from_text(std::string_view text, Vec3& value) {
    if (const auto axis = axis_in(text)) {
        value = *axis;
        return;
    }
    const auto v = numbers(text, 3, "three numbers X,Y,Z or an axis such as -z");
    value = {v[0], v[1], v[2]};
}
void from_text(std::string_view text, Rgb& value) { value = parse_color(std::string(text)); }
void from_text(std::string_view text, std::pair<double, double>& value) {
    const auto v = numbers(text, 2, "two numbers A,B");
    value = {v[0], v[1]};
}
void from_text(std::string_view text, std::array<int, 3>& value) {
    const auto v = numbers(text, 3, "three whole numbers XxYxZ");
    value = {to_int(v[0]), to_int(v[1]), to_int(v[2])};
}
void from_text(std::string_view text, std::array<double, 6>& value) {
    const auto v = numbers(text, 6, "six numbers X0,X1,Y0,Y1,Z0,Z1");
    std::copy(v.begin(), v.end(), value.begin());
}

void from_text(std::string_view text, Matrix4& value) {
    const auto v = numbers(text, 16, "sixteen numbers, a matrix row by row");
    std::copy(v.begin(), v.end(), value.begin());
}

void from_text(std::string_view text, ClipPlane& value) {
    const auto v = numbers(text, 4, "four numbers NX,NY,NZ,D");
    value = {{v[0], v[1], v[2]}, v[3]};
    if (!(length(value.normal) > 0)) refuse_text("the normal must not be 0,0,0");
}

void from_text(std::string_view text, IsoSurface& value) {
    value = {};
    if (const auto at = text.find('@'); at != text.npos) {
        value.opacity = numbers(text.substr(at + 1), 1, "an opacity after the @")[0];
        if (value.opacity < 0 || value.opacity > 1) refuse_text("the opacity must be 0 to 1");
        text = text.substr(0, at);
    }
    const auto comma = text.find(',');
    value.value = numbers(text.substr(0, comma), 1, "VALUE[,COLOR][@OPACITY]")[0];
    if (comma != text.npos) from_text(text.substr(comma + 1), value.color.emplace());
}

void from_text(std::string_view text, HistogramEffects& value) {
    value = {false, false, false, false};
    if (text == "none") return;
    const std::string_view names[] = {"ao", "bleeding", "scattering", "glow"};
    bool* const effects[] = {&value.ao, &value.bleeding, &value.scattering, &value.emission};
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        *effects[index_among(text.substr(begin, end - begin), names)] = true;
        begin = end + 1;
    }
}
void from_text(std::string_view text, ShSampling& value) {
    value = {};
    const std::string_view names[] = {"fibonacci", "jittered"};
    const auto colon = text.find(':');
    value.jittered = index_among(text.substr(0, colon), names) == 1;
    if (colon == text.npos) return;
    if (!value.jittered) refuse_text("only jittered takes a number of sets");
    value.sets = integer<int>(numbers(text.substr(colon + 1), 1, "a number of sets after the colon")[0], 1, 4096);
}

void from_text(std::string_view text, Bounces& value) {
    value = {};
    if (text == "unlimited") return;
    value.most = integer<int>(numbers(text, 1, "a number of times, or unlimited")[0], 0, 1000000);
}

void from_text(std::string_view text, ProbeExposure& value) {
    value = {};
    if (text != "auto") value.stops = numbers(text, 1, "a number of stops, or auto")[0];
}

void from_text(std::string_view text, int& width, int& height) {
    const auto v = numbers(text, 2, "WIDTHxHEIGHT");
    width = to_int(v[0]), height = to_int(v[1]);
}
void from_text(std::string_view text, Rgb& color, bool& transparent, bool& probe) {
    if (text == "probe") {
        probe = true;
        return;
    }
    transparent = text == "transparent";
    if (!transparent) color = parse_color(std::string(text));
}
void from_text(std::string_view text, Light& value) {
    constexpr std::string_view place = "at:", with_camera = "headlight";
    value = {};
    const bool is_point = text.starts_with(place);
    value.headlight = !is_point && text.substr(0, text.find(',')) == with_camera;
    if (is_point) text.remove_prefix(place.size());
    const int count = is_point ? 3 : value.headlight ? 1 : 2;
    std::size_t end = 0;  // of what comes before the colour
    for (int i = 0; i < count && end != text.npos; ++i) end = text.find(',', end + (i > 0));
    if (end != text.npos) value.color = parse_color(std::string(text.substr(end + 1)));
    if (value.headlight) return;
    const auto v = numbers(text.substr(0, end), std::size_t(count), "headlight, AZ,EL[,COLOR] or at:X,Y,Z[,COLOR]");
    if (is_point)
        value.position_mm = Vec3{v[0], v[1], v[2]};
    else
        value.azimuth_deg = v[0], value.elevation_deg = v[1];
}

std::size_t index_among(std::string_view text, std::span<const std::string_view> names) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == text) return i;
    const std::vector<std::string> candidates(names.begin(), names.end());
    refuse_text(fmt::format("must be {}{}", fmt::join(names, ", "), did_you_mean(text, candidates)));
}

namespace {

/// "2", "4" of a form "2|4".
std::vector<std::string_view> choices_of(std::string_view form) {
    std::vector<std::string_view> choices;
    for (std::size_t begin = 0; begin <= form.size();) {
        const std::size_t end = std::min(form.find('|', begin), form.size());
        choices.push_back(form.substr(begin, end - begin));
        begin = end + 1;
    }
    return choices;
}

}  // namespace

std::string range_of(const Setting& setting) {
    const bool low = std::isfinite(setting.lowest), high = std::isfinite(setting.highest);
    std::string range;
    if (low && high && !setting.lowest_excluded)
        range = fmt::format("{} to {}", setting.lowest, setting.highest);
    else if (low)
        range = fmt::format("{} {}", setting.lowest_excluded ? "above" : "at least", setting.lowest);
    if (low && high && setting.lowest_excluded) range += fmt::format(" and at most {}", setting.highest);
    if (!range.empty() && !setting.unit.empty()) range += fmt::format(" {}", setting.unit);
    return range;
}

void check_range(const Setting& setting, std::string_view text) {
    for (double value : numbers_in(text))
        if (value < setting.lowest || value > setting.highest || (setting.lowest_excluded && value == setting.lowest))
            refuse_text("must be " + range_of(setting));
}

std::string value_text(const Setting& setting, const bool& field) {
    const std::size_t bar = setting.form.find('|');
    if (bar == setting.form.npos) return to_text(field != setting.name.starts_with("no-"));
    return std::string(field ? setting.form.substr(bar + 1) : setting.form.substr(0, bar));
}

void read_value(const Setting& setting, std::string_view text, bool& field) {
    if (const std::size_t bar = setting.form.find('|'); bar != setting.form.npos) {
        const std::string_view names[] = {setting.form.substr(0, bar), setting.form.substr(bar + 1)};
        field = index_among(text, names) == 1;
    } else {
        from_text(text, field);
        field = field != setting.name.starts_with("no-");
    }
}

void read_value(const Setting& setting, std::string_view text, int& field) {
    from_text(text, field);
    if (setting.form.find('|') == setting.form.npos) return;
    const auto choices = choices_of(setting.form);
    if (std::find(choices.begin(), choices.end(), to_text(field)) == choices.end())
        refuse_text(fmt::format("must be {}", fmt::join(choices, ", ")));
}

}  // namespace chiaro
