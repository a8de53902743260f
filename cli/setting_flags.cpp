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

void SettingFlags::add(CLI::App& app, const std::string& group, const Setting& setting, const std::string& form,
                       const std::string& text) {
    const std::string flag = fmt::format("--{}", setting.name), name(setting.name), range = range_of(setting);
    std::string help(setting.sentence);
    if (!range.empty()) help += fmt::format(" ({})", range);
    if (!text.empty()) help += fmt::format(" [{}]", text);
    if (setting.repeats())
        app.add_option_function<std::vector<std::string>>(
               flag,
               [this, name](const std::vector<std::string>& all) {
                   given_[name] = fmt::format("{}", fmt::join(all, ";"));
               },
               help + " (may be repeated)")
            ->type_name(form)
            ->expected(1)
            ->take_all()
            ->group(group);
    else if (form.empty())
        app.add_flag_function(
               flag, [this, name](std::int64_t) { given_[name] = "true"; }, help)
            ->group(group);
    else
        app.add_option_function<std::string>(
               flag, [this, name](const std::string& value) { given_[name] = value; }, help)
            ->type_name(form)
            ->take_last()
            ->group(group);
}

void SettingFlags::add_to(CLI::App& app, std::string_view only_group) {
    add_to(app, [&](std::string_view group, const Setting&) { return only_group.empty() || group == only_group; });
}

void SettingFlags::add_to(CLI::App& app, const Wanted& wanted) {
    const auto add_group = [&](std::string_view title, const auto& settings) {
        const auto add_one = [&](const Setting& setting, const auto&... fields) {
            if (!setting.name.empty() && wanted(title, setting))
                add(app, std::string(title), setting, form(setting, fields...), default_text(setting, fields...));
        };
        describe(add_one, settings);
    };
    const Scene defaults;
    for_each_group(add_group, defaults);
}

void SettingFlags::apply(Scene& scene) const {
    set_by_name(scene, given_,
                [](std::string_view name, std::string_view value) { return fmt::format("--{} {}", name, value); });
}

std::string options_table() {
    std::string table;
    const auto add_row = [&](const Setting& setting, const auto&... fields) {
        const std::string how = form(setting, fields...);
        std::string flag = fmt::format("`--{}{}{}`", setting.name, how.empty() ? "" : " ", how);
        if (setting.name.empty()) flag = "scene files only";
        for (std::size_t bar = 0; (bar = flag.find('|', bar)) != flag.npos; bar += 2) flag.insert(bar, "\\");
        table += fmt::format("| {} | `{}` | {} | {} | {} |\n", flag, setting.key, setting.sentence, range_of(setting),
                             default_text(setting, fields...));
    };
    const auto add_group = [&](std::string_view title, const auto& settings) {
        table += fmt::format("\n## {}\n\n| flag | scene key | what it does | range | default |\n", title);
        table += "| --- | --- | --- | --- | --- |\n";
        describe(add_row, settings);
    };
    const Scene defaults;
    for_each_group(add_group, defaults);
    return table;
}

}  // namespace chiaro::cli
