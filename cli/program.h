// What the programs of the tool have in common: reading their arguments, and ending with a message and an exit code.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

namespace chiaro::cli {

/// False where the result was printed already: --help, --version. Throws Error{usage}.
bool parse(CLI::App& tool, int argc, char** argv);

/// Throws Error{usage} for what CLI11 could not place: an unknown option or command, or one argument too many.
void refuse_rest(const CLI::App& app);

/// Calls body(); what it throws becomes one line on standard error. Returns the exit code of the program.
int run_program(const std::function<void()>& body);

}  // namespace chiaro::cli
