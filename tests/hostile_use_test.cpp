// What the shell, the terminal and names of files can do to the tool.
#include <sys/stat.h>

#include "core/text.h"
#include "tool_case.h"

namespace chiaro {
namespace {

class HostileUse : public ToolTest {
protected:
    void SetUp() override {
        ToolTest::SetUp();
        setenv("CHIARO_DECODE", built("chiaro-decode").c_str(), 1);
    }

    /// The exit code where descriptors are closed by the shell, "0<&- 2>&-". What it says is lost.
    int code_with(const std::string& streams, const std::string& arguments) {
        const std::string line = "cd " + folder.string() + " && " + built("chiaro ") + arguments + " " + streams;
        const int status = std::system(("(" + line + ") 2>/dev/null").c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }
};

TEST_F(HostileUse, ClosedStreamsAreErrorsOfWhoeverUsesThem) {
    EXPECT_EQ(code_with("<&- >&- 2>&-", "info none.nrrd"), 3);
    EXPECT_EQ(code_with("<&- >&- 2>&-", "render sample:ball:8 --size 8x8 -o a.png"), 0);
    EXPECT_FALSE(read("a.png").empty());
    EXPECT_EQ(code_with("2>&-", "info none.nrrd"), 3);
    EXPECT_EQ(code_with("2>/dev/full", "info none.nrrd"), 3);
    EXPECT_EQ(
        code_with("2>/dev/full", "render sample:ball:96 --progress always --size 8x8 --lighting histogram -o b.png"),
        0);
    EXPECT_EQ(code_with(">&-", "info sample:ball:8"), 4);
    EXPECT_EQ(code_with("<&-", "info -"), 3);
    EXPECT_EQ(code_with("<&-", "info sample:ball:8 >/dev/null"), 0);
}

// Nobody writes to the FIFO: whoever opens it for reading waits.
TEST_F(HostileUse, SmallFilesAreRegularFiles) {
    ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
    for (const char* link : {"fifo.png", "fifo.hdr"}) std::filesystem::create_symlink("fifo", folder / link);
    write("tf.json", R"({"volume": {"file": "sample:ball:8"}, "transfer_function": {"file": "fifo"}})");
    write("probe.json", R"({"volume": {"file": "sample:ball:8"}, "probe": {"file": "fifo.hdr"}})");
    const std::string render = "render sample:ball:8 --size 8x8 -o a.png ";
    for (const std::string& arguments :
         std::vector<std::string>{"render -o a.png --scene fifo", "render -o a.png --scene tf.json",
                                  "render -o a.png --scene probe.json", render + "--transfer ./fifo",
                                  render + "--probe ./fifo", "convert ./fifo b.json", "compare fifo.png fifo.png",
                                  render + "--lighting histogram --hist-effects glow --glow ./fifo", "info fifo"}) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, 3) << arguments << said.err;
        EXPECT_NE(said.err.find("regular file"), said.err.npos) << arguments << said.err;
    }
    EXPECT_EQ(read("a.png"), "");
}

// C1 controls, directions turned round, bytes that are no UTF-8, and ESC: no terminal sees them.
TEST_F(HostileUse, NamesReachTheTerminalAsText) {
    const std::string name =
        "a\xc2\x9b"
        "31m\xe2\x80\xae\xe2\x81\xa6\xff\xed\xa0\x80\x1b[2J\xc3\xa4.nrrd";
    const std::string shown = "a\ufffd31m\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd [2J\u00e4.nrrd";
    ASSERT_EQ(tool("sample ball --size 8 -o v.nrrd").code, 0);
    std::filesystem::rename(folder / "v.nrrd", folder / name);
    EXPECT_EQ(tool("info '" + name + "'").out.substr(0, shown.size() + 1), shown + "\n");
    EXPECT_EQ(tool("info 'none" + name + "'").err.substr(0, 27 + shown.size()),
              "chiaro: cannot read 'none" + shown + "':");
    const std::string json = tool("info --json '" + name + "'").out;
    EXPECT_EQ(json.find_first_of("\x1b\xff"), json.npos);
    EXPECT_NE(json.find(R"(a\u009b31m\u202e\u2066)"), json.npos) << json;
    EXPECT_EQ(tool("render '" + name + "' --size 8x8 -o p.png --stats s.json --quiet").code, 0);
    EXPECT_EQ(read("s.json").find_first_of("\x1b\xff"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(json)["file"], nlohmann::json::parse(read("s.json"))["volume"]["file"]);
}

TEST(Text, IsCutBetweenCharacters) {
    EXPECT_EQ(one_line("\u00e4\u00e4\u00e4", 5), "\u00e4\u00e4...");
    EXPECT_EQ(one_line("\u00e4\u00e4\u00e4", 6), "\u00e4\u00e4\u00e4");
    EXPECT_EQ(one_line("\xf0\x9f\x98\x80\xf0\x9f\x98"), "\U0001f600\ufffd\ufffd\ufffd");
    EXPECT_EQ(one_line("\xc0\x80\xf4\x90\x80\x80"), "\ufffd\ufffd\ufffd\ufffd\ufffd\ufffd");  // overlong, too large
    EXPECT_EQ(one_line("a\tb\nc\x7f"
                       "d\u2028e"),
              "a b c d\ufffde");
}

TEST(Text, DepthOfJson) {
    EXPECT_FALSE(is_deeper_than(2, R"({"[[[\"[[[": [1], "b": [0]})"));
    EXPECT_TRUE(is_deeper_than(2, R"({"\\": [[1]]})"));
    EXPECT_TRUE(is_deeper_than(2, "[[["));
}

TEST(Text, MembersOfJsonStatedTwice) {
    EXPECT_EQ(member_stated_twice(R"({"a": {"b": 1}, "b": [{"b": 1}, {"b": "a\""}], "c": "b:"})"), "");
    EXPECT_EQ(member_stated_twice(R"({"a": {"b": 1, "c": {"b": 1}, "b": 2}})"), "b");
    EXPECT_EQ(member_stated_twice(R"([{"\"a": 1, "\"a": 1}])"), R"(\"a)");
}

// Parsers take the first or the last and say nothing.
TEST_F(HostileUse, WhatIsStatedTwiceIsRefused) {
    write("a.json", R"({"volume": {"file": "sample:ball:8"}, "camera": {"zoom": 1, "zoom": 2}})");
    write("b.json", R"({"points": [{"value": 0, "opacity": 0, "opacity": 1}]})");
    write("c.tfi", R"(<TransFuncIntensity><lower value="0" value="1"/></TransFuncIntensity>)");
    for (const auto& [arguments, what] :
         {std::pair{"render -o a.png --scene a.json", "'zoom'"}, std::pair{"convert b.json b2.json", "'opacity'"},
          std::pair{"convert c.tfi c.json", "value of <lower>"}}) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, 3) << arguments;
        EXPECT_NE(said.err.find(std::string("states ") + what + " twice"), said.err.npos) << said.err;
    }
    EXPECT_EQ(files(), "a.json b.json c.tfi");
}

// One line a key would be 100000, and a search by the names of all others before took 10^10 steps.
TEST_F(HostileUse, UnknownKeysAreCounted) {
    nlohmann::json scene{{"volume", {{"file", "sample:ball:8"}}}, {"camera", {{"azimuth_dge", 1}}}};
    for (int i = 0; i < 100000; ++i) scene["k" + std::to_string(i)] = i;
    write("many.json", scene.dump());
    const Said said = tool("render --scene many.json --size 8x8 -o a.png --stats s.json");
    EXPECT_EQ(said.code, 0);
    EXPECT_NE(said.err.find("unknown key camera.azimuth_dge; did you mean 'azimuth_deg'?\n"), said.err.npos);
    EXPECT_NE(said.err.find(" (and 99993 others)\n"), said.err.npos) << said.err;
    EXPECT_LT(std::count(said.err.begin(), said.err.end(), '\n'), 12);
}

// A pipe that is full and that nobody reads: the tool waits in `write`, where no Progress is looked at.
TEST_F(HostileUse, OneSignalEndsItWhereverItIs) {
    ASSERT_EQ(tool("sample ball --size 8 -o sample.nrrd").code, 0);
    ASSERT_EQ(tool("convert sample.nrrd v.nrrd").code, 0);
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_NONBLOCK), 0);
    const std::string page(4096, ' ');
    while (::write(ends[1], page.data(), page.size()) > 0) {
    }
    ASSERT_EQ(fcntl(ends[1], F_SETFL, 0), 0);
    const pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDERR_FILENO);
        if (chdir(folder.c_str()) == 0)
            execl(built("chiaro").c_str(), "chiaro", "render", "v.nrrd", "-o", "v.png", nullptr);  // tells its guess
        _exit(127);
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));  // or longer: where it has not come so far it ends as well
    kill(child, SIGTERM);
    for (int i = 0; i < 600 && !has_ended(child); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(has_ended(child));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 130) << status;
    close(ends[0]), close(ends[1]);
}

}  // namespace
}  // namespace chiaro
