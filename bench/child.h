// The tool, measured from outside.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace chiaro::bench {

/// A folder in the system's place for temporary files, gone with all that it holds when this is.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

/// Runs a program to its end; returns the CPU seconds of it and of those that it started. Throws Error{internal}
/// unless it ends with 0.
double run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments);

}  // namespace chiaro::bench
