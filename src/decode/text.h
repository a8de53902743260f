// Words and numbers of text headers.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::decode {

using Fields = std::map<std::string, std::string>;

std::string trimmed(std::string_view text);
std::string lower(std::string_view text);
/// Split at blanks, and at every character of `separators`.
std::vector<std::string> words(std::string_view text, std::string_view separators = "");

/// Throw Error{input} naming `what` for text that is not one number; nan and inf are numbers here.
double number(const std::string& text, const std::string& what);
std::int64_t integer(const std::string& text, const std::string& what);
std::vector<double> numbers(const std::string& text, const std::string& what);
std::vector<std::int64_t> integers(const std::string& text, const std::string& what);
bool boolean(const std::string& text, const std::string& what);  ///< true, false, 1, 0, yes, no

/// The value of a field, or `fallback`.
std::string value_or(const Fields& fields, const std::string& name, const std::string& fallback = "");
/// Throws Error{input} when the field is missing.
const std::string& required(const Fields& fields, const std::string& name);

}  // namespace chiaro::decode
