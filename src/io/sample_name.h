// sample:NAME and sample:NAME:SIZE.
#pragma once
#include <string>
#include <utility>

namespace chiaro {

inline bool is_sample_name(const std::string& name) { return name.starts_with("sample:"); }
/// NAME and SIZE, 0 where none is given. Throws Error{usage} for a size that is none.
std::pair<std::string, int> split_sample_name(const std::string& name);

}  // namespace chiaro
