// What stands beside a row of the GPU.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::bench {

/// In the row's unit.
struct Beside {
    struct Figure {
        double value;
        std::string_view of;  ///< which way, on which machine
    };
    std::vector<Figure> papers;    ///< what they measured for the same work
    std::optional<double> target;  ///< what a GPU like an H200 should take at most
};

/// Of a row that is not quick; nothing where there is nothing.
Beside beside(std::string_view row);

}  // namespace chiaro::bench
