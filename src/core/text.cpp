#include "core/text.h"

#include <fmt/format.h>

namespace chiaro {

std::string to_text(double number) { return fmt::format("{}", number); }

}  // namespace chiaro
