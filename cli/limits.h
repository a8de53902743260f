// What a comparison found, and the limits that --fail-above and --fail-below set.
#pragma once
#include <chiaro/compare.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace chiaro::cli {

/// Of a distance less is better, of a likeness more.
enum class Kind { distance, likeness };

struct Metric {
    std::string name;
    double value;
    Kind kind = Kind::distance;
};
using Metrics = std::vector<Metric>;

Metrics metrics_of(const ImageDifference& difference);

/// The limits METRIC=V.
struct Limits {
    std::vector<std::string> above, below;

    void add_to(CLI::App& app);
    /// A phrase for each limit that does not hold; what cannot be computed holds none. Throws Error{usage}.
    std::vector<std::string> broken(const Metrics& metrics) const;
};

}  // namespace chiaro::cli
