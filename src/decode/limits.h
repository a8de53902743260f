// What the helper may use of the machine: set on itself before it looks at the file.
#pragma once
#include <cstdint>

#include "decode/system_calls.h"

namespace chiaro::decode {

struct Limits {
    std::uint64_t max_bytes = 0;  ///< of voxels; working memory comes on top
    unsigned cpu_seconds = 0;
    bool is_by_request = false;  ///< of processor time: limit_cpu_from_now may grant more
    int last_descriptor = 4;     ///< of those that were handed over
    Permissions permissions{};
};

/// From now on the process may have so many more bytes of memory of its own than it has: what a library allocates
/// before it looks whether the file holds as much. The voxels' memory file is not counted. Each call replaces the one
/// before; where the kernel does not say how much there is, the limit of limit_this_process stays alone.
void limit_own_memory(std::uint64_t bytes);

/// Limits memory, CPU time, file size and open files; forbids core dumps and all that restrict_system_calls does;
/// ties the helper's life to its parent's. Whatever the kernel lacks is left out: the parent checks the results all the
/// same.
void limit_this_process(const Limits& limits);

/// From now on the process may use so many more seconds of processor time.
void limit_cpu_from_now(unsigned seconds);

}  // namespace chiaro::decode
