// The manual page, the completions, and what every command accepts.
#include "tool_case.h"

namespace {

using Outline = ToolTest;

const char* const commands[] = {"info", "sample", "render", "illuminate", "convert", "compare", "view", "bench"};

TEST_F(Outline, EveryCommandTakesTheCommonOptions) {
    for (const std::string command : commands) {
        const Said help = tool(command + " --help");
        for (const char* option : {"--quiet", "--verbose", "--threads", "--progress"}) {
            EXPECT_NE(help.out.find(option), std::string::npos) << command << " " << option;
            EXPECT_NE(tool("--print man").out.find(command), std::string::npos);
        }
        // Checked for each, before it misses its other arguments.
        EXPECT_NE(tool(command + " --threads -1").err.find("threads -1: must be 0"), std::string::npos) << command;
        EXPECT_NE(tool(command + " --progress now").err.find("--progress now: must be"), std::string::npos) << command;
    }
}

TEST_F(Outline, QuietIsSilentAndVerboseTellsStages) {
    struct Case {
        const char *arguments, *stage;
    };
    for (const auto& [arguments, stage] : {Case{"sample ball --size 16 -o a.nrrd", "sample"},
                                           {"info a.nrrd", "measure"},
                                           {"convert a.nrrd b.nrrd", "write"},
                                           {"compare a.nrrd b.nrrd", "compare"},
                                           {"render a.nrrd -o a.png --size 32x24", "raycast"},
                                           {"illuminate a.nrrd -o f.nrrd", "write"}}) {
        const Said quiet = tool(std::string(arguments) + " --quiet --threads 1");
        EXPECT_EQ(quiet.code, 0) << quiet.err;
        EXPECT_EQ(quiet.err, "") << arguments;
        const Said verbose = tool(std::string(arguments) + " --verbose --threads 1");
        EXPECT_NE(verbose.err.find(", 1 threads:"), std::string::npos) << verbose.err;
        EXPECT_NE(verbose.err.find(std::string(" ") + stage + " "), std::string::npos) << verbose.err;
    }
}

class Shell : public ToolTest {
protected:
    Said shell(const std::string& script) {
        write("script", script);
        const int code = std::system(("cd " + folder.string() + " && sh ./script >.said 2>.err").c_str());
        return {WEXITSTATUS(code), read(".said"), read(".err")};
    }
};

TEST_F(Shell, ManualPageHasNoWarnings) {
    ASSERT_EQ(tool("--print man > chiaro.1").code, 0);
    const Said said = shell("command -v groff >/dev/null || exit 0; " + built("chiaro") +
                            " --print man | groff -man -ww -Tutf8 2>&1 >/dev/null");
    EXPECT_EQ(said.out, "");
    EXPECT_EQ(tool("--print mam").code, 2);
}

TEST_F(Shell, BashCompletes) {
    const std::string script = R"(cat > complete.bash <<'END'
source ./chiaro.bash
try() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _chiaro; echo "${COMPREPLY[*]}"; }
touch picture.nrrd
try chiaro re
try chiaro render --lightin
try chiaro render x --lighting t
try chiaro render x --lighting = t
try chiaro render sample : tu
try chiaro render pic
try chiaro view --data nowhere
END
)" + built("chiaro") + R"( --print bash > chiaro.bash && bash -n chiaro.bash && bash complete.bash)";
    EXPECT_EQ(shell(script).out, "render\n--lighting\ntransport\ntransport\ntubes\npicture.nrrd\n\n");
}

TEST_F(Shell, OtherShellsReadTheirs) {
    for (const std::string name : {"zsh", "fish"}) {
        const Said said = shell("command -v " + name + " >/dev/null || exit 0; " + built("chiaro") + " --print " +
                                name + " > c && " + name + " -n c");
        EXPECT_EQ(said.code, 0) << said.err;
    }
    const Said fish = shell("command -v fish >/dev/null || { echo render; exit 0; }; " + built("chiaro") +
                            " --print fish > c; HOME=$PWD fish -c 'source c; complete -C \"chiaro rend\"'");
    EXPECT_TRUE(fish.out.starts_with("render")) << fish.out << fish.err;
}

}  // namespace
