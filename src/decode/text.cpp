#include "decode/text.h"

#include "decode/output.h"

#include <fmt/format.h>

#include <charconv>

namespace chiaro::decode {
namespace {

constexpr std::string_view blanks = " \t\r\n\v\f";

template <class Number>
Number parse(std::string_view text, const std::string& what) {
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        refuse(fmt::format("its '{}' holds '{}' where a number is expected", what, text.substr(0, 40)));
    return value;
}

template <class Number>
std::vector<Number> parse_all(const std::string& text, const std::string& what) {
    std::vector<Number> values;
    for (const auto& word : words(text)) values.push_back(parse<Number>(word, what));
    return values;
}

}  // namespace

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return result;
}

std::vector<std::string> words(std::string_view text, std::string_view separators) {
    const std::string all = std::string(blanks) + std::string(separators);
    std::vector<std::string> result;
    for (auto first = text.find_first_not_of(all); first != std::string_view::npos;) {
        const auto last = text.find_first_of(all, first);
        result.emplace_back(text.substr(first, last - first));
        first = last == std::string_view::npos ? last : text.find_first_not_of(all, last);
    }
    return result;
}

double number(const std::string& text, const std::string& what) { return parse<double>(trimmed(text), what); }
std::int64_t integer(const std::string& text, const std::string& what) {
    return parse<std::int64_t>(trimmed(text), what);
}
std::vector<double> numbers(const std::string& text, const std::string& what) { return parse_all<double>(text, what); }
std::vector<std::int64_t> integers(const std::string& text, const std::string& what) {
    return parse_all<std::int64_t>(text, what);
}

bool boolean(const std::string& text, const std::string& what) {
    const std::string word = lower(trimmed(text));
    if (word == "true" || word == "1" || word == "yes") return true;
    if (word == "false" || word == "0" || word == "no") return false;
    refuse(fmt::format("its '{}' is '{}', not true or false", what, word.substr(0, 40)));
}

std::string value_or(const Fields& fields, const std::string& name, const std::string& fallback) {
    const auto found = fields.find(name);
    return found == fields.end() ? fallback : found->second;
}

const std::string& required(const Fields& fields, const std::string& name) {
    const auto found = fields.find(name);
    if (found == fields.end()) refuse("its header has no '" + name + "'");
    return found->second;
}

}  // namespace chiaro::decode
