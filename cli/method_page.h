// The page that `chiaro compare VOLUME --methods -o PAGE.html` writes.
#pragma once
#include <chiaro/comparison.h>

#include <string>

namespace chiaro::cli {

/// Needs nothing beside itself, no script either. `title` is what was compared, `told` a sentence on the light.
std::string page_of(const MethodComparison& comparison, const std::string& title, const std::string& told);

}  // namespace chiaro::cli
