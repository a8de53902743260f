// How much memory there is.
#pragma once
#include <cstdint>

namespace chiaro {

/// Bytes that the process may still take without harm: what the kernel calls available, or what is left of the limit of
/// its control group.
std::uint64_t available_memory();

/// `most` bytes where that is not 0, else what is available.
inline std::uint64_t memory_within(std::uint64_t most) { return most > 0 ? most : available_memory(); }

}  // namespace chiaro
