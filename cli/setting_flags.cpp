#include "setting_flags.h"

#include <chiaro/describe.h>
#include <chiaro/error.h>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

std::string form(const Setting& setting, const auto&... fields) {
    return setting.form.empty() ? form_of(fields...) : std::string(setting.form);
}

std::string default_text(const Setting& setting, const auto&... fields) {
    const bool is_switch = form(setting, fields...).empty();
    return is_switch ? "" : value_text(setting, fields...);
}

}  // namespace

void SettingFlags::add_to(CLI::App& app, std::string_view only_group) {
    Scene defaults;
    for_each_group(
        [&](std::string_view title, auto& settings) {
            if (!only_group.empty() && title != only_group) return;
            describe(
                [&](const Setting& setting, const auto&... fields) {
                    const std::string flag = fmt::format("--{}", setting.name), name(setting.name);
                    std::string help(setting.sentence);
                    if (const std::string range = range_of(setting); !range.empty())
                        help += fmt::format(" ({})", range);
                    if (const std::string text = default_text(setting, fields...); !text.empty())
                        help += fmt::format(" [{}]", text);
                    const std::string how = form(setting, fields...);
                    CLI::Option* option =
                        how.empty() ? app.add_flag_function(
                                          flag, [this, name](std::int64_t) { given_[name] = "true"; }, help)
                                    : app.add_option_function<std::string>(
                                             flag, [this, name](const std::string& text) { given_[name] = text; }, help)
                                          ->type_name(how)
                                          ->take_last();
                    option->group(std::string(title));
                },
                settings);
        },
        defaults);
}

void SettingFlags::apply(Scene& scene) const {
    const auto is_given = [&](std::string_view name) { return given_.contains(name); };
    // Of settings that replace each other, one on the command line puts away the scene's.
    if (is_given("transfer")) scene.transfer.points.reset();
    if (is_given("opacity-unit") != is_given("opacity-unit-mm"))
        scene.transfer.opacity_unit.reset(), scene.transfer.opacity_unit_mm.reset();
    const bool turns_orbit = is_given("azimuth") || is_given("elevation") || is_given("view");
    if (turns_orbit) scene.camera.eye.reset(), scene.camera.target.reset();
    if (turns_orbit || is_given("eye") || is_given("target")) scene.camera.view.reset();

    for_each_setting(
        [&](const Setting& setting, auto&... fields) {
            const auto found = given_.find(setting.name);
            if (found == given_.end()) return;
            const std::string who = fmt::format("--{} {}", setting.name, found->second);
            set(setting, found->second, who, ErrorCode::usage, fields...);
        },
        scene);
    check(scene, ErrorCode::usage);
}

std::string options_table() {
    std::string text;
    Scene defaults;
    for_each_group(
        [&](std::string_view title, auto& settings) {
            text += fmt::format(
                "\n## {}\n\n| flag | scene key | what it does | range | default |\n| --- | --- | --- | --- | --- |\n",
                title);
            describe(
                [&](const Setting& setting, const auto&... fields) {
                    std::string flag = fmt::format("--{} {}", setting.name, form(setting, fields...));
                    for (std::size_t bar = 0; (bar = flag.find('|', bar)) != flag.npos; bar += 2)
                        flag.insert(bar, "\\");
                    text +=
                        fmt::format("| `{}` | `{}` | {} | {} | {} |\n", flag.substr(0, flag.find_last_not_of(' ') + 1),
                                    setting.key, setting.sentence, range_of(setting), default_text(setting, fields...));
                },
                settings);
        },
        defaults);
    return text;
}

}  // namespace chiaro::cli
