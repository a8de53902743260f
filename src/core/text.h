// Numbers and names in messages.
#pragma once
#include <string>

namespace chiaro {

/// The shortest decimal that reads back as the same number: "0.1", "-1024", "nan".
std::string to_text(double number);

/// What a file or its name may smuggle into a message: control characters become blanks, and more than `longest` bytes
/// are cut off.
std::string one_line(std::string text, std::size_t longest = 400);

}  // namespace chiaro
