// Of volumes that do not fit in memory.
#pragma once
#include <chiaro/session.h>

#include <CLI/CLI.hpp>
#include <string>

namespace chiaro::cli {

struct PagingOptions {
    std::string memory;  // as it is written: 4G
    int level = 0;
    bool exact = false;
};

void add_memory_option(CLI::App& app, PagingOptions& options);
/// That, and the level.
void add_paging_options(CLI::App& app, PagingOptions& options);
/// Throws Error{usage} for what is no size, or no level.
PagingSettings paging_of(const PagingOptions& options);
}  // namespace chiaro::cli
