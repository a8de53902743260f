// What the tool takes, read off its own option tables: for the manual page and the completions of shells.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace chiaro::cli {

/// What can stand in a value's place.
struct Candidates {
    std::vector<std::string> words;
    bool files = false, folders = false;
    bool operator<(const Candidates& other) const {
        return std::tie(words, files, folders) < std::tie(other.words, other.files, other.folders);
    }
};

struct OptionOutline {
    std::vector<std::string> names;  ///< "-o", "--output"; one without dashes: by its position
    std::string form;                ///< how the value is written; "": a switch
    std::string help, group;
    bool repeats = false;
    Candidates candidates;

    bool is_positional() const { return !names.front().starts_with("-"); }
};

struct CommandOutline {
    std::string name;  ///< "" of the tool itself
    std::string help;
    std::vector<OptionOutline> options;  ///< without hidden ones
};

struct Outline {
    CommandOutline tool;
    std::vector<CommandOutline> commands;
};

Outline outline_of(const CLI::App& tool);

std::string manual_page(const Outline& outline);
std::string bash_completion(const Outline& outline);
std::string zsh_completion(const Outline& outline);
std::string fish_completion(const Outline& outline);

/// Prints "man" or what completes commands in a shell: "bash", "zsh", "fish". Throws Error{usage} for anything else.
void print_outline(const CLI::App& tool, const std::string& what);

}  // namespace chiaro::cli
