// Settings that were given and change nothing.
#pragma once
#include <chiaro/describe.h>
#include <chiaro/scene.h>

#include <string>
#include <vector>

namespace chiaro::cli {

/// A sentence for each of those given that the scene, which has them, makes no use of: "--probe: ...". What is not
/// known to be unused is left out.
std::vector<std::string> unused_settings(const GivenSettings& given, const Scene& scene);

}  // namespace chiaro::cli
