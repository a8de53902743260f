// The flags of the settings that <chiaro/describe.h> tells.
#pragma once
#include <chiaro/scene.h>
#include <chiaro/settings.h>

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <string_view>

namespace chiaro::cli {

class SettingFlags {
public:
    /// Adds a flag for each setting of the named group, or of all groups. `this` must outlive the parsing.
    void add_to(CLI::App& app, std::string_view only_group = "");

    /// Sets what was given on the command line, which wins over what the scene says. Throws Error{usage}.
    void apply(Scene& scene) const;

private:
    void add(CLI::App& app, const std::string& group, const Setting& setting, const std::string& form,
             const std::string& text);

    std::map<std::string, std::string, std::less<>> given_;
};

/// The table of all settings as Markdown: docs/options.md.
std::string options_table();

}  // namespace chiaro::cli
