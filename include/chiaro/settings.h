// Settings told once: every settings struct has `describe(visitor, settings)`, which hands each field to the visitor with
// its name, unit, range and one sentence. Flags, --help, JSON, validation and the documentation's tables come from it.
#pragma once
#include <limits>
#include <string_view>

namespace chiaro {

/// What there is to know about one setting beside its value; the default is the field's initial value.
struct Setting {
    std::string_view name;      ///< the flag without dashes, "early-termination"
    std::string_view key;       ///< where it lives in a scene file, "sampling.early_termination"
    std::string_view unit;      ///< "" when it has none
    std::string_view sentence;  ///< what it does, in one line
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool lowest_excluded = false;  ///< the range is open at `lowest`
};

}  // namespace chiaro
