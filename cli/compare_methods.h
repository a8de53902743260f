// chiaro compare VOLUME --methods: lighting methods beside the path-traced ground truth.
#pragma once
#include <filesystem>
#include <string>

#include "limits.h"
#include "scene_source.h"

namespace chiaro::cli {

struct MethodsOptions {
    std::string names;  ///< separated by commas; empty: files are compared
    std::string volume;
    std::filesystem::path scene, data, output;

    void add_to(CLI::App& app);
};

/// Prints a line for each method; with an output writes a page and a contact sheet beside it. Throws Error{difference}
/// where a method breaks a limit.
void compare_on_volume(const MethodsOptions& options, const Limits& limits, bool as_json, const SettingFlags& flags,
                       const CommonOptions& common);

}  // namespace chiaro::cli
