// Files of which each holds one moment of the same thing.
#pragma once
#include <chiaro/io.h>

#include <functional>

namespace chiaro {

/// Whether it is a pattern, and no file of that very name.
bool is_moment_pattern(const std::string& name);

/// Reads the file of the moment `options.time` of a pattern by `read`, and tells of the others.
Volume read_moment_file(const std::string& pattern, const ReadOptions& options,
                        const std::function<Volume(const std::string& file, const ReadOptions&)>& read);

}  // namespace chiaro
