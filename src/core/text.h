// Numbers in messages.
#pragma once
#include <fmt/format.h>

#include <string>

namespace chiaro {

/// The shortest decimal that reads back as the same number: "0.1", "-1024", "nan".
inline std::string to_text(double number) { return fmt::format("{}", number); }

}  // namespace chiaro
