// chiaro bench: starts the benchmarks, a program of their own that is not built by default.
#include <chiaro/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "command.h"

namespace chiaro::cli {
namespace {

[[noreturn]] void start(const std::vector<std::string>& arguments) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "chiaro-bench";
    std::vector<char*> pointers{const_cast<char*>(program.c_str())};
    for (const auto& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    if (errno == ENOENT)
        throw Error(ErrorCode::output,
                    "the benchmarks are a program of their own, chiaro-bench, which is not beside this one: "
                    "'scripts/build release chiaro-bench' builds it");
    throw Error(ErrorCode::output, program + " cannot be started: " + std::strerror(errno));
}

}  // namespace

Command bench_command(CLI::App& tool) {
    CLI::App* app = tool.add_subcommand("bench", "Measures how fast this build is here: starts chiaro-bench");
    app->set_help_flag();  // it has its own
    app->prefix_command();
    return {app, [app] { start(app->remaining()); }, true};
}

}  // namespace chiaro::cli
