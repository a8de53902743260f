// What the rows of a GPU share.
#pragma once
#include "rows.h"

namespace chiaro::bench {

inline constexpr const char* no_gpu = "skipped: no CUDA device (--device cuda)";
inline Row skipped(const std::string& name, const char* unit, const char* why) { return {name, unit, {}, {}, {}, why}; }

/// One reading of so many bytes there, which takes half of what copying them does.
double pass_ms(const Setup& setup, std::size_t bytes);

std::vector<Case> gpu_light_cases(const Setup& setup);

}  // namespace chiaro::bench
