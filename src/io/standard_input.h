// Standard input as a file that can be read twice.
#pragma once
#include "io/helper_process.h"

#include <chiaro/io.h>

namespace chiaro {

/// Copies standard input into a memory file. Throws Error{input} when it is longer than `options` permits or stalls,
/// Error{interrupted} when cancelled.
Descriptor spool_standard_input(const ReadOptions& options, Progress& progress);

}  // namespace chiaro
