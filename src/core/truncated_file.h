// Files that become shorter while they are read.
#pragma once
#include <sys/stat.h>

#include <cstdint>

namespace chiaro {

/// Whether an open file ends before `end`, up to where it has been read. One that is cut meanwhile may give zeros in
/// place of what stood behind the cut; its size tells.
inline bool is_cut(int descriptor, std::uint64_t end) {
    struct stat status {};
    return fstat(descriptor, &status) != 0 || std::uint64_t(status.st_size) < end;
}

inline constexpr const char* was_cut = "it was cut short while it was read";

}  // namespace chiaro
