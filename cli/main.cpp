// The tool: names the commands, tells errors in one line, and ends with the error's code.
#include <chiaro/error.h>
#include <fmt/format.h>

#include <new>
#include <vector>

#include "command.h"
#include "common.h"
#include "core/did_you_mean.h"
#include "lists.h"

namespace chiaro::cli {
namespace {

constexpr Command (*commands[])(CLI::App&) = {info_command, sample_command, render_command, convert_command, bench_command};

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

int run(int argc, char** argv) {
    CLI::App tool{"Chiaro: natural light for volumes", "chiaro"};
    tool.allow_extras();
    tool.set_version_flag("--version", std::string("chiaro ") + CHIARO_VERSION);
    tool.get_formatter()->column_width(36);
    List lists[] = {{"--list-methods", "lists the lighting methods", list_methods},
                    {"--list-formats", "lists the volume formats", list_formats},
                    {"--list-presets", "lists transfer-function presets and colour maps", list_presets},
                    {"--list-devices", "lists the devices", list_devices},
                    {"--list-options", "", list_options}};
    for (List& list : lists) tool.add_flag(list.flag, list.wanted, list.help)->group(*list.help ? "Options" : "");
    std::vector<Command> all;
    for (const auto make : commands) {
        all.push_back(make(tool));
        all.back().app->allow_extras();
    }
    try {
        tool.parse(argc, argv);
    } catch (const CLI::Success& asked) {  // --help, --version
        return tool.exit(asked);
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorCode::usage, error.what());
    }
    for (const Command& command : all) {
        if (!command.app->parsed()) continue;
        refuse_rest(*command.app);
        command.run();
        return 0;
    }
    refuse_rest(tool);
    bool listed = false;
    for (const List& list : lists)
        if (list.wanted) list.print(), listed = true;
    if (!listed) throw Error(ErrorCode::usage, "no command given; see chiaro --help");
    return 0;
}

}  // namespace
}  // namespace chiaro::cli

int main(int argc, char** argv) {
    using namespace chiaro;
    try {
        return cli::run(argc, argv);
    } catch (const Error& error) {
        cli::say(error.what());
        return int(error.code());
    } catch (const std::bad_alloc&) {
        cli::say("not enough memory");
        return int(ErrorCode::output);
    } catch (const std::exception& error) {
        cli::say(fmt::format("internal error: {}", error.what()));
        return int(ErrorCode::internal);
    }
}
