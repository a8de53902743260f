// Numbers and names in messages.
#pragma once
#include <chiaro/export.h>

#include <string>
#include <string_view>

namespace chiaro {

/// The shortest decimal that reads back as the same number: "0.1", "-1024", "nan".
CHIARO_EXPORT std::string to_text(double number);

/// What a file or its name may smuggle into a message, made harmless: control characters become blanks, what else a
/// terminal obeys or shows the other way round (C1, direction marks, separators of lines) and bytes that are no UTF-8
/// become U+FFFD; of more than `longest` bytes the rest is cut off, between two characters.
std::string one_line(std::string_view text, std::size_t longest = 400);

/// JSON in UTF-8 that a terminal shows as it is: what it would obey is written as \uXXXX, which means the same.
std::string printable_json(std::string_view json);

/// A member that an object of this JSON, which must be valid, states twice, as it is spelled there; empty where there
/// is none. Parsers take the last one and say nothing.
std::string_view member_stated_twice(std::string_view json);

/// The same as a sentence's end, "states 'zoom' twice".
std::string json_contradiction(std::string_view json);

/// Whether JSON is nested deeper than `most`, in one pass: copying and printing it recurse.
bool is_deeper_than(int most, std::string_view json);

}  // namespace chiaro
