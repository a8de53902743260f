// The manual page, in the macros of man(7).
#include <fmt/format.h>

#include <algorithm>

#include "outline.h"

namespace chiaro::cli {
namespace {

constexpr const char* own_group = "Options";  // CLI11's, of what has none

/// The letter at `at` of text in UTF-8, which moves behind it.
unsigned next_letter(const std::string& text, std::size_t& at) {
    const unsigned char first = text[at++];
    if (first < 0x80) return first;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    unsigned letter = first & (0x3F >> more);
    for (int i = 0; i < more && at < text.size(); ++i) letter = letter << 6 | (text[at++] & 0x3F);
    return letter;
}

/// As text of roff: no letter of it is an instruction, whatever the line it begins.
std::string roff(const std::string& text) {
    std::string escaped = "\\&";
    for (std::size_t at = 0; at < text.size();) {
        const unsigned letter = next_letter(text, at);
        if (letter == '\\')
            escaped += "\\e";
        else if (letter == '-')
            escaped += "\\-";
        else if (letter == '\n')
            escaped += "\n.br\n\\&";
        else if (letter < 0x80)
            escaped += char(letter);
        else
            escaped += fmt::format("\\[u{:04X}]", letter);
    }
    return escaped;
}

std::string entry(const OptionOutline& option) {
    std::string names;
    for (const auto& name : option.names)
        names +=
            fmt::format("{}{}{}\\fR", names.empty() ? "" : ", ", option.is_positional() ? "\\fI" : "\\fB", roff(name));
    const std::string value = option.form.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(option.form));
    return fmt::format(".TP\n{}{}\n{}\n", names, value, roff(option.help));
}

std::vector<std::string> groups_of(const CommandOutline& command) {
    std::vector<std::string> groups;
    for (const auto& option : command.options)
        if (option.group != own_group && !option.is_positional() &&
            std::find(groups.begin(), groups.end(), option.group) == groups.end())
            groups.push_back(option.group);
    return groups;
}

std::string command_section(const CommandOutline& command) {
    std::string title = "chiaro " + command.name + " [OPTION]...", entries;
    for (const auto& option : command.options) {
        if (option.is_positional()) title += " [" + option.names[0] + "]" + (option.repeats ? "..." : "");
        if (option.is_positional() || option.group == own_group) entries += entry(option);
    }
    std::string text = fmt::format(".SS {}\n{}.\n{}", roff(title), roff(command.help), entries);
    if (const auto groups = groups_of(command); !groups.empty())
        text += fmt::format(".PP\nOptions of these kinds too, told below: {}.\n",
                            roff(fmt::format("{}", fmt::join(groups, ", "))));
    return text;
}

/// The options that commands share, once each.
std::string shared_sections(const Outline& outline) {
    std::vector<std::string> groups;
    std::vector<OptionOutline> options;
    for (const auto& command : outline.commands) {
        for (const auto& group : groups_of(command))
            if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
        for (const auto& option : command.options) {
            const auto same = [&](const OptionOutline& o) {
                return o.names == option.names && o.group == option.group;
            };
            if (option.group != own_group && !option.is_positional() &&
                std::none_of(options.begin(), options.end(), same))
                options.push_back(option);
        }
    }
    std::string text = ".SH OPTIONS OF SEVERAL COMMANDS\n";
    for (const auto& group : groups) {
        text += fmt::format(".SS {}\n", roff(group));
        for (const auto& option : options)
            if (option.group == group) text += entry(option);
    }
    return text;
}

constexpr const char* end_of_page = R"(.SH EXIT STATUS
.TP
0
done
.TP
1
a fault of the program
.TP
2
a wrong option or argument
.TP
3
a file that cannot be read
.TP
4
a file that cannot be written, or too little memory
.TP
5
a difference beyond a stated limit
.TP
130
interrupted
.SH ENVIRONMENT
.TP
\fBCHIARO_DECODE\fR
the helper program that reads volumes, where it does not lie beside the tool
.TP
\fBCHIARO_VIEW_TOKEN\fR
the word in the address of \fBchiaro view\fR, the same for each start
.TP
\fBXDG_CACHE_HOME\fR
holds the folder for prepared volumes; else ~/.cache
.SH EXAMPLES
.TP
\fBchiaro render sample:tubes \-o tubes.png\fR
a picture of a generated volume
.TP
\fBchiaro view scan.nii.gz\fR
explores a scan in the browser
.TP
\fBchiaro render scan.nrrd \-o scan.png \-\-lighting transport \-\-probe studio\fR
scattered light from a light probe
)";

}  // namespace

std::string manual_page(const Outline& outline) {
    std::string text = fmt::format(".TH CHIARO 1 \"\" \"chiaro {}\" \"User Commands\"\n.ad l\n.nh\n", CHIARO_VERSION);
    text +=
        ".SH NAME\nchiaro \\- natural light for volumes\n.SH SYNOPSIS\n\\fBchiaro\\fR \\fICOMMAND\\fR "
        "[\\fIOPTION\\fR]...\n";
    text += ".SH DESCRIPTION\nRenders volumes (CT, MR, microscopy, simulations) with natural light.\n.SH OPTIONS\n";
    for (const auto& option : outline.tool.options) text += entry(option);
    text += ".SH COMMANDS\n";
    for (const auto& command : outline.commands) text += command_section(command);
    return text + shared_sections(outline) + end_of_page;
}

}  // namespace chiaro::cli
