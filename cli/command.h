// The commands of the tool, one file each.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

namespace chiaro::cli {

/// A command's options stand in `app`; `run` is called when the command was named, and throws Error.
struct Command {
    CLI::App* app;
    std::function<void()> run;
    bool takes_any_argument = false;  ///< hands its arguments on to another program
};

Command info_command(CLI::App& tool);
Command sample_command(CLI::App& tool);
Command render_command(CLI::App& tool);
Command illuminate_command(CLI::App& tool);
Command convert_command(CLI::App& tool);
Command compare_command(CLI::App& tool);
Command view_command(CLI::App& tool);
Command bench_command(CLI::App& tool);

}  // namespace chiaro::cli
