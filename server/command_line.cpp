#include "command_line.h"

#include <chiaro/describe.h>
#include <fmt/format.h>

#include <map>

namespace chiaro::server {
namespace {

/// As one word of a shell.
std::string quoted(const std::string& word) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
    if (!word.empty() && word.find_first_not_of(plain) == word.npos) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

struct Flag {
    std::string value;
    bool is_switch, repeats;
};

/// The settings' values by the names of their flags.
std::map<std::string, Flag> flags_of(const Scene& scene) {
    std::map<std::string, Flag> flags;
    for_each_setting(
        [&](const Setting& setting, const auto&... fields) {
            const bool concerns = setting.concerns(to_text(scene.illumination.method));
            if (setting.name.empty() || setting.key == "transfer_function" || !concerns) return;
            const std::string form = setting.form.empty() ? form_of(fields...) : std::string(setting.form);
            flags[std::string(setting.name)] = {value_text(setting, fields...), form.empty(), setting.repeats()};
        },
        scene);
    return flags;
}

void append(std::string& command, const std::string& name, const Flag& flag) {
    if (flag.is_switch) {
        command += fmt::format(" --{}", name);
        return;
    }
    for (std::size_t begin = 0; begin <= flag.value.size();) {
        const std::size_t end =
            flag.repeats ? std::min(flag.value.find(';', begin), flag.value.size()) : flag.value.size();
        const std::string value = flag.value.substr(begin, end - begin);
        // A value that begins with '-' must not be taken for a flag.
        command += value.starts_with("-") ? fmt::format(" --{}={}", name, quoted(value))
                                          : fmt::format(" --{} {}", name, quoted(value));
        begin = end + 1;
    }
}

}  // namespace

std::string command_line(const Scene& scene, const std::string& preset, const std::string& output) {
    std::string before, command = fmt::format("chiaro render {} -o {}", quoted(scene.volume), quoted(output));
    if (!preset.empty()) {
        command += fmt::format(" --transfer {}", quoted(preset));
    } else if (scene.transfer.points) {
        before = fmt::format("cat > transfer.json <<'END'\n{}\nEND\n", to_json(*scene.transfer.points));
        command += " --transfer transfer.json";
    } else if (!scene.transfer.source.empty()) {
        command += fmt::format(" --transfer {}", quoted(scene.transfer.source));
    }
    Scene plain;  // by the same method, whose settings alone are told
    plain.illumination.method = scene.illumination.method;
    const auto defaults = flags_of(plain);
    for (const auto& [name, flag] : flags_of(scene)) {
        const auto found = defaults.find(name);
        const bool is_default = found != defaults.end() && found->second.value == flag.value;
        if ((!is_default && !flag.value.empty()) || (name == "lighting" && flag.value != "spao"))
            append(command, name, flag);
    }
    return before + command;
}

}  // namespace chiaro::server
