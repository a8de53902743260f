// The tool: names the commands, tells errors in one line, and ends with the error's code.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <cstdio>
#include <new>
#include <system_error>
#include <vector>

#include "command.h"
#include "common.h"
#include "core/did_you_mean.h"
#include "interrupt.h"
#include "lists.h"
#include "outline.h"

namespace chiaro::cli {
namespace {

constexpr Command (*commands[])(CLI::App&) = {info_command,    sample_command,  render_command, illuminate_command,
                                              convert_command, compare_command, view_command,   bench_command};

struct List {
    const char* flag;
    const char* help;
    void (*print)();
    bool wanted = false;
};

/// What CLI11 could not place: an unknown option or command, or one argument too many.
void refuse_rest(const CLI::App& app) {
    const auto rest = app.remaining();
    if (rest.empty()) return;
    const std::string word = rest.front().substr(0, rest.front().find('='));
    std::vector<std::string> known;
    if (!word.starts_with("-"))
        for (const auto* command : app.get_subcommands({})) known.push_back(command->get_name());
    else
        for (const auto* option : app.get_options())
            for (const auto& name : option->get_lnames()) known.push_back(fmt::format("--{}", name));
    const char* what = word.starts_with("-") ? "option" : known.empty() ? "argument" : "command";
    throw Error(ErrorCode::usage, fmt::format("unknown {} '{}'{}", what, word, did_you_mean(word, known)));
}

/// False where the answer was printed already: --help, --version.
bool parse(CLI::App& tool, int argc, char** argv) {
    try {
        tool.parse(argc, argv);
        return true;
    } catch (const CLI::Success& asked) {
        tool.exit(asked);
        return false;
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorCode::usage, error.what());
    }
}

void run(int argc, char** argv) {
    CLI::App tool{"Chiaro: natural light for volumes", "chiaro"};
    tool.allow_extras();  // so that refuse_rest can say what was meant
    tool.set_version_flag("--version", std::string("chiaro ") + CHIARO_VERSION);
    tool.get_formatter()->column_width(36);
    List lists[] = {{"--list-methods", "lists the lighting methods", list_methods},
                    {"--list-formats", "lists the formats of volumes and transfer functions", list_formats},
                    {"--list-presets", "lists transfer-function presets and colour maps", list_presets},
                    {"--list-devices", "lists the devices", list_devices},
                    {"--list-options", "", list_options}};
    for (List& list : lists) tool.add_flag(list.flag, list.wanted, list.help)->group(*list.help ? "Options" : "");
    std::string printed;
    tool.add_option("--print", printed)->group("");  // man, bash, zsh or fish: what cmake/pages.cmake installs
    std::vector<Command> all;
    for (const auto command : commands) {
        all.push_back(command(tool));
        all.back().app->allow_extras();
    }
    if (!parse(tool, argc, argv)) return;
    for (const Command& command : all) {
        if (!command.app->parsed()) continue;
        refuse_rest(*command.app);
        return command.run();
    }
    refuse_rest(tool);
    if (!printed.empty()) return print_outline(tool, printed);
    bool listed = false;
    for (const List& list : lists)
        if (list.wanted) list.print(), listed = true;
    if (!listed) throw Error(ErrorCode::usage, "no command given; see chiaro --help");
}

}  // namespace
}  // namespace chiaro::cli

int main(int argc, char** argv) {
    using namespace chiaro;
    cli::prepare_for_signals();
    try {
        cli::run(argc, argv);
        if (std::fflush(stdout) != 0) throw Error(ErrorCode::output, "standard output cannot be written to");
        return 0;
    } catch (const Error& error) {
        cli::say(error.what());
        return int(error.code());
    } catch (const std::bad_alloc&) {
        cli::say("not enough memory");
        return int(ErrorCode::output);
    } catch (const std::system_error& error) {  // of fmt: a full disk, a closed pipe
        cli::say(error.what());
        return int(ErrorCode::output);
    } catch (const std::exception& error) {
        cli::say(fmt::format("internal error: {}", error.what()));
        return int(ErrorCode::internal);
    }
}
