// The flags of the settings that <chiaro/describe.h> tells.
#pragma once
#include <chiaro/describe.h>
#include <chiaro/scene.h>
#include <chiaro/settings.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace chiaro::cli {

class SettingFlags {
public:
    using Wanted = std::function<bool(std::string_view group, const Setting&)>;

    /// Adds a flag for each setting of the named group, of all groups, or that is wanted. `this` must outlive the
    /// parsing.
    void add_to(CLI::App& app, std::string_view only_group = "");
    void add_to(CLI::App& app, const Wanted& wanted);

    bool any() const { return !given_.empty(); }
    const GivenSettings& given() const { return given_; }
    /// Sets what was given on the command line, which wins over what the scene says. Throws Error{usage}.
    void apply(Scene& scene) const;

private:
    void add(CLI::App& app, const std::string& group, const Setting& setting, const std::string& form,
             const std::string& text);

    GivenSettings given_;
};

/// The table of all settings as Markdown: docs/options.md.
std::string options_table();

}  // namespace chiaro::cli
