// Numbers in messages.
#pragma once
#include <string>

namespace chiaro {

/// The shortest decimal that reads back as the same number: "0.1", "-1024", "nan".
std::string to_text(double number);

}  // namespace chiaro
