// Options that every working command takes.
#pragma once
#include <chiaro/device.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <string_view>

namespace chiaro::cli {

struct CommonOptions {
    std::string device = "auto", isa, progress = "auto";
    int threads = 0;
    bool quiet = false, verbose = false;
    std::filesystem::path stats;
};

/// The number of threads holds from the end of parsing on, for the whole process. Parsing throws Error{usage} for
/// values out of range.
void add_common_options(CLI::App& app, CommonOptions& options);

/// The device that the options ask for; of one that was chosen by itself a line tells. Throws Error{usage} for a name
/// that is none, Error{output} for one not there.
Device device_of(const CommonOptions& options);

/// One line on standard error.
void say(std::string_view line);

}  // namespace chiaro::cli
