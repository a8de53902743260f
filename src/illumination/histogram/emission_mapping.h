// Which values glow, and how strongly.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

/// h(value) >= 1, where 1 does not glow: one strength between two values, or straight lines between the points of a
/// file; 1 outside.
class EmissionMapping {
public:
    EmissionMapping() = default;
    /// "LO:HI=STRENGTH", or a file of lines "VALUE STRENGTH", values not falling; '#' begins a comment. Throws
    /// Error{usage} for a mapping, Error{input} for a file that cannot be read.
    explicit EmissionMapping(const std::string& text);

    double at(double value) const;

private:
    /// What is wrong with a point behind those that are there, or nothing.
    std::string fault_of(double value, double strength) const;
    std::vector<std::pair<double, double>> points_;
};

}  // namespace chiaro
