// Completions of commands, options and their values, for three shells.
#include <fmt/format.h>

#include <map>

#include "outline.h"

namespace chiaro::cli {
namespace {

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::string replaced(std::string text, std::string_view letters, std::string_view before) {
    for (std::size_t at = 0; (at = text.find_first_of(letters, at)) != text.npos; at += before.size() + 1)
        text.insert(at, before);
    return text;
}

/// In single quotes, for bash and zsh.
std::string quoted(const std::string& text) {
    std::string safe;
    for (char c : text) safe += c == '\'' ? "'\\''" : c == '\n' ? " " : std::string(1, c);
    return "'" + safe + "'";
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Of bash: `words` and `files` for each place of a value, the same for all places with the same candidates.
std::string bash_values(const Outline& outline) {
    std::map<Candidates, std::string> places;
    const auto add = [&](const CommandOutline& command) {
        for (const auto& option : command.options) {
            if (option.form.empty() && !option.is_positional()) continue;
            for (const auto& name : option.names) {
                std::string& text = places[option.candidates];
                text += fmt::format("{}'{} {}'", text.empty() ? "" : "|", command.name,
                                    option.is_positional() ? "*" : name);
            }
        }
    };
    add(outline.tool);
    for (const auto& command : outline.commands) add(command);
    std::string cases;
    for (const auto& [candidates, text] : places)
        cases += fmt::format("        {})\n            words={} files={} ;;\n", text, quoted(joined(candidates.words)),
                             candidates.files     ? "f"
                             : candidates.folders ? "d"
                                                  : "''");
    return cases;
}

std::string names_of_options(const CommandOutline& command) {
    std::vector<std::string> names;
    for (const auto& option : command.options)
        if (!option.is_positional()) names.insert(names.end(), option.names.begin(), option.names.end());
    return joined(names);
}

constexpr const char* bash_frame = R"(# bash completion for chiaro, made by `chiaro --print bash`
_chiaro_values() {{ # COMMAND OPTION, or COMMAND '*' for what stands by itself: sets words and files; 1: none such
    case "$1 $2" in
{values}        *) return 1 ;;
    esac
}}
_chiaro_options() {{
    case "$1" in
{options}    esac
}}
_chiaro() {{
    local typed=() i word command='' place='*' words='' files='' current cut
    for ((i = 1; i <= COMP_CWORD; i++)); do # bash cuts words at : and =
        word=${{COMP_WORDS[i]}}
        if ((${{#typed[@]}})) && [[ $word == [:=]* || ${{typed[-1]}} == *[:=] ]]; then typed[-1]+=$word; else typed+=("$word"); fi
    done
    current=${{typed[-1]}}
    if ((${{#typed[@]}} > 1)) && [[ ${{typed[0]}} != -* ]]; then command=${{typed[0]}}; fi
    if [[ $current == --*=* ]]; then
        place=${{current%%=*}} current=${{current#*=}}
    elif ((${{#typed[@]}} > 1)) && [[ ${{typed[-2]}} == -* ]] && _chiaro_values "$command" "${{typed[-2]}}"; then
        place=${{typed[-2]}}
    fi
    if [[ $place == '*' && $current == -* ]] || [[ -z $command && $place == '*' ]]; then
        words=$(_chiaro_options "$command") files=''
        [[ -n $command || $current == -* ]] || words='{commands}'
    else
        words='' files=''
        _chiaro_values "$command" "$place"
    fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    if [[ $files ]]; then
        compopt -o filenames 2>/dev/null
        while IFS= read -r word; do COMPREPLY+=("$word"); done < <(compgen "-$files" -- "$current")
    fi
    cut=${{current%"${{current##*:}}"}}
    [[ $COMP_WORDBREAKS != *:* || -z $cut ]] || COMPREPLY=("${{COMPREPLY[@]#"$cut"}}")
}}
complete -F _chiaro chiaro
)";

/// What zsh's _arguments offers for a value.
std::string zsh_action(const Candidates& candidates) {
    std::vector<std::string> actions;
    if (candidates.files) actions.push_back("files:file:_files");
    if (candidates.folders) actions.push_back("folders:folder:_files -/");
    if (!candidates.words.empty())
        actions.push_back(fmt::format("values:value:({})", replaced(joined(candidates.words), ":", "\\")));
    if (actions.empty()) return " ";
    std::string text = "_alternative";
    for (const auto& action : actions) text += " \"" + action + "\"";
    return "{" + replaced(text, ":", "\\") + "}";
}

std::string zsh_option(const OptionOutline& option) {
    const std::string help = replaced(first_line(option.help), "\\[]:", "\\");
    std::string specs;
    const std::string value = option.form.empty() ? ""
                                                  : fmt::format(":{}:{}", replaced(option.form, "\\[]:", "\\"),
                                                                zsh_action(option.candidates));
    for (const auto& name : option.names)
        specs +=
            " \\\n                " + quoted(fmt::format("{}{}[{}]{}", option.repeats ? "*" : "", name, help, value));
    return specs;
}

std::string zsh_arguments(const CommandOutline& command) {
    std::string text;
    int position = 0;
    for (const auto& option : command.options)
        text += option.is_positional()
                    ? " \\\n                " +
                          quoted(fmt::format("{}:{}:{}", option.repeats ? "*" : fmt::format("{}", ++position),
                                             option.names[0], zsh_action(option.candidates)))
                    : zsh_option(option);
    return text;
}

/// In single quotes, for fish.
std::string fish_quoted(const std::string& text) { return "'" + replaced(first_line(text), "\\'", "\\") + "'"; }

std::string fish_line(const std::string& condition, const OptionOutline& option) {
    std::string line = fmt::format("complete -c chiaro -n '{}'", condition);
    if (!option.is_positional())
        for (const auto& name : option.names)
            line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    const Candidates& c = option.candidates;
    if (!option.is_positional() && !option.form.empty()) line += c.files || c.folders ? " -r -F" : " -x";
    if (option.is_positional() && c.files) line += " -F";
    if (!c.words.empty()) line += " -a " + fish_quoted(joined(c.words));
    return line + " -d " + fish_quoted(option.help) + "\n";
}

}  // namespace

std::string bash_completion(const Outline& outline) {
    std::vector<std::string> commands;
    std::string options = fmt::format("        '') echo {} ;;\n", quoted(names_of_options(outline.tool)));
    for (const auto& command : outline.commands) {
        commands.push_back(command.name);
        options += fmt::format("        {}) echo {} ;;\n", command.name, quoted(names_of_options(command)));
    }
    return fmt::format(bash_frame, fmt::arg("values", bash_values(outline)), fmt::arg("options", options),
                       fmt::arg("commands", joined(commands)));
}

std::string zsh_completion(const Outline& outline) {
    std::string commands, cases;
    for (const auto& command : outline.commands) {
        commands += fmt::format("            {}\n", quoted(command.name + ":" + command.help));
        cases += fmt::format("        {})\n            _arguments{} ;;\n", command.name, zsh_arguments(command));
    }
    std::string tool = zsh_arguments(outline.tool);
    return fmt::format(
        "#compdef chiaro\n# made by `chiaro --print zsh`\n_chiaro() {{\n    local curcontext=\"$curcontext\" state "
        "line\n"
        "    local -a commands\n    _arguments -C{} \\\n                '1:command:->command' "
        "'*::argument:->argument'\n"
        "    case $state in\n    command)\n        commands=(\n{}        )\n        _describe command commands ;;\n"
        "    argument)\n        case $words[1] in\n{}        esac ;;\n    esac\n}}\n_chiaro \"$@\"\n",
        tool, commands, cases);
}

std::string fish_completion(const Outline& outline) {
    std::string text = "# fish completion for chiaro, made by `chiaro --print fish`\ncomplete -c chiaro -f\n";
    for (const auto& option : outline.tool.options) text += fish_line("__fish_use_subcommand", option);
    for (const auto& command : outline.commands) {
        text += fmt::format("complete -c chiaro -n __fish_use_subcommand -a {} -d {}\n", command.name,
                            fish_quoted(command.help));
        for (const auto& option : command.options)
            text += fish_line("__fish_seen_subcommand_from " + command.name, option);
    }
    return text;
}

}  // namespace chiaro::cli
