// Sums that do not depend on which thread took which piece.
#pragma once
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/threads.h"

namespace chiaro {

/// part(0) + part(1) + ... + part(count - 1), the parts in parallel, their sum in order.
template <class Part>
auto ordered_sum(std::int64_t count, const Part& part) {
    using Sum = decltype(part(std::int64_t(0)));
    std::vector<Sum> parts(count);
    parallel_for(count, 8, [&](std::int64_t first, std::int64_t last) {
        for (auto i = first; i < last; ++i) parts[i] = part(i);
    });
    return std::accumulate(parts.begin(), parts.end(), Sum());
}

}  // namespace chiaro
