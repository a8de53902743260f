#include "core/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>
#include <vector>

namespace chiaro {
namespace {

constexpr std::string_view replacement = "\xef\xbf\xbd";  // U+FFFD

/// A character and its bytes; of 0 where they are no UTF-8 (Unicode 15, table 3-7).
struct Character {
    char32_t code = 0;
    std::size_t bytes = 1;
    bool valid = false;
};

Character character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return at + i < text.size() ? unsigned(text[at + i]) & 0xffu : 0u; };
    const unsigned first = byte(0);
    if (first < 0x80) return {char32_t(first), 1, true};
    const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    char32_t code = first & (0x7fu >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0u) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr char32_t least[] = {0x80, 0x800, 0x10000};
    const bool valid =
        first >= 0xc2 && code >= least[bytes - 2] && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff);
    return valid ? Character{code, bytes, true} : Character{};
}

bool is_obeyed(char32_t code) {
    return (code >= 0x7f && code <= 0x9f) || code == 0x61c || code == 0x200e || code == 0x200f ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string to_text(double number) { return fmt::format("{}", number); }

std::string one_line(std::string_view text, std::size_t longest) {
    std::string line;
    for (std::size_t at = 0; at < text.size();) {
        const Character c = character_at(text, at);
        const bool is_control = c.valid && (c.code < 32 || c.code == 127);
        const std::string_view shown = is_control                      ? " "
                                       : !c.valid || is_obeyed(c.code) ? replacement
                                                                       : text.substr(at, c.bytes);
        if (line.size() + shown.size() > longest) return line + "...";
        line += shown;
        at += c.bytes;
    }
    return line;
}

std::string printable_json(std::string_view json) {
    std::string text;
    for (std::size_t at = 0; at < json.size();) {
        const Character c = character_at(json, at);
        if (is_obeyed(c.code))
            text += fmt::format("\\u{:04x}", unsigned(c.code));
        else
            text += json.substr(at, c.bytes);
        at += c.bytes;
    }
    return text;
}

namespace {

/// Calls on_mark(mark, last) for each of { } [ ] : outside of strings, with the string before it, until that says true.
template <class OnMark>
bool any_mark(std::string_view json, const OnMark& on_mark) {
    std::string_view last;
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (json[i] == '"') {
            const std::size_t first = ++i;
            while (i < json.size() && json[i] != '"') i += json[i] == '\\' ? 2 : 1;
            last = json.substr(std::min(first, json.size()), i - first);
        } else if (std::string_view("{}[]:").find(json[i]) != std::string_view::npos && on_mark(json[i], last)) {
            return true;
        }
    }
    return false;
}

}  // namespace

bool is_deeper_than(int most, std::string_view json) {
    int depth = 0;
    return any_mark(json, [&](char mark, std::string_view) {
        depth += (mark == '{' || mark == '[') - (mark == '}' || mark == ']');
        return depth > most;
    });
}

std::string_view member_stated_twice(std::string_view json) {
    std::vector<std::unordered_set<std::string_view>> open;  // the members so far of each object or array around
    std::string_view twice;
    any_mark(json, [&](char mark, std::string_view last) {
        if (mark == '{' || mark == '[')
            open.emplace_back();
        else if (open.empty())
            return true;
        else if (mark != ':')
            open.pop_back();
        else if (!open.back().insert(last).second)
            twice = last;
        return !twice.empty();
    });
    return twice;
}

std::string json_contradiction(std::string_view json) {
    const std::string_view name = member_stated_twice(json);
    return name.empty() ? "" : "states '" + one_line(name) + "' twice";
}

}  // namespace chiaro
