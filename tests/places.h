// Where this build and its sources are.
#pragma once
#include <string>

/// The path of a program of this build, such as "chiaro".
std::string built(const std::string& program);
/// The path of a file of the project, such as "docs/options.md".
std::string of_project(const std::string& file);
