// The whole tool, for whoever starts it: the program, and that of the Python package, which lies in its library.
#pragma once
#include <chiaro/export.h>

namespace chiaro::cli {

/// What main does; returns the exit code.
CHIARO_EXPORT int run_tool(int argc, char** argv);

}  // namespace chiaro::cli
