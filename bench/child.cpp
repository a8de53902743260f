#include "child.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

namespace chiaro::bench {
namespace fs = std::filesystem;
namespace {

double seconds(const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); }

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::string pattern = fs::temp_directory_path() / "chiaro-bench-XXXXXX";
    if (!mkdtemp(pattern.data()))
        throw Error(ErrorCode::output, fmt::format("no folder can be made in {}", fs::temp_directory_path().string()));
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code left_behind;
    fs::remove_all(path_, left_behind);
}

double run_program(const fs::path& program, const std::vector<std::string>& arguments) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_t child = 0;
    int status = 0;
    rusage usage{};
    if (posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ) != 0)
        throw Error(ErrorCode::internal, fmt::format("{} cannot be started", program.string()));
    while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    if (status != 0)
        throw Error(ErrorCode::internal,
                    fmt::format("{} {} failed", program.filename().string(), fmt::join(arguments, " ")));
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace chiaro::bench
