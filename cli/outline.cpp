#include "outline.h"

#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>
#include <chiaro/transfer_function.h>
#include <fmt/format.h>

#include <cctype>

#include "core/did_you_mean.h"

namespace chiaro::cli {
namespace {

std::vector<std::string> parts_of(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

/// A part of a form that is to be written as it stands: "cuda[:N]" gives "cuda", "CENTER,WIDTH" nothing.
std::vector<std::string> words_of(const std::string& part) {
    const std::string fixed = part.substr(0, part.find('['));
    std::vector<std::string> words;
    for (const std::string& word : parts_of(fixed, ',')) {
        bool is_word = !word.empty() && std::isalnum(static_cast<unsigned char>(word[0]));
        for (unsigned char c : word) is_word = is_word && c < 128 && !std::isupper(c) && c != '=';
        if (!is_word) return {};
        words.push_back(word);
    }
    return words;
}

/// What the form of a value itself tells: "auto|cpu", "FILE|PRESET", "DIR".
Candidates candidates_of_form(const std::string& form) {
    Candidates found;
    for (const std::string& part : parts_of(form, '|')) {
        for (const char* name : {"FILE", "IMAGE", "FIELD", "PAGE", "VOLUME"})
            found.files = found.files || part.starts_with(name);
        found.folders = found.folders || part == "DIR";
        for (const std::string& word : words_of(part)) found.words.push_back(word);
    }
    return found;
}

void add_known_names(const std::string& command, const OptionOutline& option, Candidates& candidates) {
    const std::string& name = option.names.back();
    const bool is_volume = name == "VOLUME" || name == "A" || name == "B" || name == "IN";
    if (is_volume || name == "OUT") candidates.files = true;
    if (is_volume)
        for (const SampleInfo& sample : list_samples()) candidates.words.push_back("sample:" + sample.name);
    if (command == "sample" && name == "NAME")
        for (const SampleInfo& sample : list_samples()) candidates.words.push_back(sample.name);
    if (name == "--transfer")
        for (const PresetInfo& preset : chiaro::list_presets()) candidates.words.push_back(preset.name);
    if (name == "--methods")
        for (const auto method : names_of(Method{})) candidates.words.emplace_back(method);
}

OptionOutline outline_of_option(const std::string& command, const CLI::Option& option) {
    OptionOutline outline;
    if (option.nonpositional()) {
        for (const auto& name : option.get_snames()) outline.names.push_back("-" + name);
        for (const auto& name : option.get_lnames()) outline.names.push_back("--" + name);
    } else {
        outline.names.push_back(option.get_name(true));
    }
    const bool is_switch = option.get_items_expected_max() == 0;
    outline.form = is_switch || outline.is_positional() ? "" : option.get_type_name();
    outline.help = option.get_description();
    outline.group = option.get_group();
    outline.repeats = option.get_items_expected_max() > 1;
    outline.candidates = candidates_of_form(outline.form);
    add_known_names(command, outline, outline.candidates);
    return outline;
}

CommandOutline outline_of_command(const CLI::App& app, const std::string& name) {
    CommandOutline outline{name, app.get_description(), {}};
    for (const CLI::Option* option : app.get_options())
        if (!option->get_group().empty()) outline.options.push_back(outline_of_option(name, *option));
    return outline;
}

}  // namespace

Outline outline_of(const CLI::App& tool) {
    Outline outline{outline_of_command(tool, ""), {}};
    for (const CLI::App* command : tool.get_subcommands({}))
        outline.commands.push_back(outline_of_command(*command, command->get_name()));
    return outline;
}

void print_outline(const CLI::App& tool, const std::string& what) {
    struct Kind {
        const char* name;
        std::string (*text)(const Outline&);
    };
    std::vector<std::string> names;
    for (const Kind& kind : {Kind{"man", manual_page}, Kind{"bash", bash_completion}, Kind{"zsh", zsh_completion},
                             Kind{"fish", fish_completion}}) {
        if (kind.name == what) return fmt::print("{}", kind.text(outline_of(tool)));
        names.push_back(kind.name);
    }
    throw Error(ErrorCode::usage,
                fmt::format("--print {}: must be man, bash, zsh or fish{}", what, did_you_mean(what, names)));
}

}  // namespace chiaro::cli
