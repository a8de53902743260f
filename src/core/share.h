// Shares of a range as wide as all doubles, whose width is no double.
#pragma once
#include <cmath>

namespace chiaro {

/// Where `value` lies between low (0) and high (1).
inline double share_between(double low, double high, double value) {
    const double width = high - low;
    return std::isfinite(width) ? (value - low) / width : (value / 2 - low / 2) / (high / 2 - low / 2);
}

/// The inverse.
inline double at_share(double low, double high, double share) {
    const double width = high - low;
    return std::isfinite(width) ? low + share * width : std::lerp(low, high, share);
}

}  // namespace chiaro
