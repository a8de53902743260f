// The tool: names the commands, tells errors in one line, and ends with the error's code.
#include <chiaro/device.h>
#include <chiaro/error.h>
#include <fmt/format.h>

#include <vector>

#include "command.h"
#include "lists.h"
#include "outline.h"
#include "program.h"
#include "tool.h"

namespace chiaro::cli {
namespace {

constexpr Command (*commands[])(CLI::App&) = {info_command,    sample_command,  render_command, illuminate_command,
                                              convert_command, compare_command, view_command,   bench_command};

/// The version, and what this build can use.
std::string version() {
    std::string kernels;
    for (const Isa isa : built_isas()) kernels += fmt::format("{}{}", kernels.empty() ? "" : ", ", name_of(isa));
    return fmt::format("chiaro {}\nkernels: {}\nCUDA: {}", CHIARO_VERSION, kernels, built_with_cuda() ? "yes" : "no");
}

struct List {
    const char* flag;
    const char* help;
    void (*print)();
    bool wanted = false;
};

void run(int argc, char** argv) {
    CLI::App tool{"Chiaro: natural light for volumes", "chiaro"};
    tool.allow_extras();  // so that refuse_rest can say what was meant
    tool.set_version_flag("--version", version);
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
        if (!command.takes_any_argument) refuse_rest(*command.app);
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

int run_tool(int argc, char** argv) {
    return run_program([&] { run(argc, argv); });
}

}  // namespace chiaro::cli
