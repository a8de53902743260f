#include "program.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <cstdio>
#include <new>
#include <system_error>
#include <vector>

#include "common.h"
#include "core/did_you_mean.h"
#include "interrupt.h"

namespace chiaro::cli {

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

int run_program(const std::function<void()>& body) {
    open_standard_streams();
    prepare_for_signals();
    try {
        body();
        if (std::fflush(stdout) != 0) throw Error(ErrorCode::output, "standard output cannot be written to");
        return 0;
    } catch (const Error& error) {
        say(error.what());
        return int(error.code());
    } catch (const std::bad_alloc&) {
        say("not enough memory");
        return int(ErrorCode::output);
    } catch (const std::system_error& error) {  // of fmt: a full disk, a closed pipe
        say(error.what());
        return int(ErrorCode::output);
    } catch (const std::exception& error) {
        say(fmt::format("internal error: {}", error.what()));
        return int(ErrorCode::internal);
    }
}

}  // namespace chiaro::cli
