// A scene as the command that makes its picture.
#pragma once
#include <chiaro/scene.h>

#include <string>

namespace chiaro::server {

/// For a shell: `chiaro render VOLUME -o OUTPUT` with a flag for each setting that is not at its default. Points of a
/// transfer function that are not those of the preset it is named after are written to a file first.
std::string command_line(const Scene& scene, const std::string& preset, const std::string& output);

}  // namespace chiaro::server
