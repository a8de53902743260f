// Full disks, inputs that vanish, folders that cannot be written to, Ctrl-C and SIGKILL at random moments of every
// command that writes: the target stays the old file or becomes the whole new one.
// CHIARO_INTERRUPTIONS sets how many times each command is interrupted.
#include "tool_case.h"

#include <chiaro/error.h>
#include <grp.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <random>

namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

struct Command {
    std::string arguments;
    std::vector<std::string> targets;
};

class Interruption : public ToolTest {
protected:
    std::mt19937 random{20};
    /// What a child does before it becomes the tool.
    std::function<void()> before_start = [] {};

    pid_t start(const std::string& arguments) {
        const std::string line = "exec " + built("chiaro ") + arguments + " >.out 2>.err";
        const pid_t child = fork();
        if (child != 0) return child;
        before_start();
        if (chdir(folder.c_str()) == 0) execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
        _exit(127);
    }
    Said ended(pid_t child) {
        int status = 0;
        waitpid(child, &status, 0);
        const Said said{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read(".out"), read(".err")};
        fs::remove(folder / ".out"), fs::remove(folder / ".err");
        return said;
    }
    Said run(const std::string& arguments) { return ended(start(arguments)); }

    /// Whether a file is what its name promises, to the last byte.
    bool is_whole(const std::string& name) {
        const fs::path path = folder / name;
        chiaro::Progress progress;
        try {
            if (name.ends_with(".png")) return chiaro::read_png(path).width > 0;
            if (name.ends_with(".exr")) return chiaro::read_exr(path).width > 0;
            if (name.ends_with(".nrrd")) return chiaro::read_volume(path, {}, progress).voxels.size() > 0;
            if (name.ends_with(".json")) return json(name).is_object();
            return read(name).ends_with("</html>\n");
        } catch (const std::exception&) {
            return false;
        }
    }

    std::string all_unresolved() const {
        std::string names;
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().filename().string().starts_with(".chiaro-")) names += entry.path().filename().string();
        return names;
    }

    /// Every command that writes, on something that takes a moment.
    static std::vector<Command> commands() {
        const std::string loud = "sample:menger:24 --size 160x120 --threads 2 ", small = loud + "--quiet ",
                          histogram = loud + "--lighting histogram --hist-radius 4 --hist-clusters 64 ";
        return {{"sample fog --size 96 -o a.nrrd", {"a.nrrd"}},
                {"convert in.nrrd b.nrrd --encoding gzip", {"b.nrrd"}},
                {"convert ct-bone c.json", {"c.json"}},
                {"render " + small + "-o d.png --stats d.json", {"d.png", "d.json"}},
                {"render " + small + "-o e.exr", {"e.exr"}},
                {"render " + small + "--frames 3 -o f{frame}.png", {"f0.png", "f1.png", "f2.png"}},
                {"render " + histogram + "--cache kept -o g.png", {"g.png"}},
                {"illuminate sample:menger:64 --lighting spao --quiet -o h.nrrd --stats h.json", {"h.nrrd", "h.json"}},
                {"compare sample:menger:16 --methods none,spao --size 32x24 --reference-rays 2 --quiet -o i.html",
                 {"i.html", "i.png"}}};
    }

    void prepare_input() {
        ASSERT_EQ(run("sample shells --size 64 -o in.nrrd").code, 0);
        setenv("CHIARO_DECODE", built("chiaro-decode").c_str(), 1);
    }

    /// Interrupts each command `times` times, at moments spread over what it takes and a little more.
    void interrupt_all(int signal) {
        const char* stated = std::getenv("CHIARO_INTERRUPTIONS");
        const int times = stated ? std::atoi(stated) : 5;
        prepare_input();
        for (const Command& command : commands()) {
            const auto begin = std::chrono::steady_clock::now();
            const Said undisturbed = run(command.arguments);
            ASSERT_EQ(undisturbed.code, 0) << command.arguments << "\n" << undisturbed.err;
            const std::chrono::duration<double> takes = std::chrono::steady_clock::now() - begin;
            for (int i = 0; i < times; ++i) interrupt(command, signal, takes.count());
            if (command.arguments.find("--cache") != std::string::npos) {
                EXPECT_EQ(run(command.arguments).err, "") << "a damaged cache?";
            }
            for (const auto& target : command.targets) fs::remove(folder / target);
        }
    }

private:
    void interrupt(const Command& command, int signal, double takes) {
        const bool has_old = random() % 2;
        for (const auto& target : command.targets) {
            fs::remove(folder / target);
            if (has_old) write(target, "the old one");
        }
        if (random() % 2) fs::remove_all(folder / "kept");
        const double moment = takes * 1.1 * double(random() % 1000) / 1000;
        const pid_t child = start(command.arguments);
        std::this_thread::sleep_for(std::chrono::duration<double>(moment));
        kill(child, signal);
        const Said said = ended(child);
        const std::string what = fmt::format("{}, signal {} after {:.3f} s", command.arguments, signal, moment);
        EXPECT_TRUE(said.code == 0 || said.code == (signal == SIGKILL ? -SIGKILL : 130) || said.code == -signal)
            << what << ": " << said.code << said.err;
        if (said.code == 130 && !said.err.empty()) EXPECT_EQ(said.err, "chiaro: interrupted\n") << what;
        for (const auto& target : command.targets) {
            const bool is_there = fs::exists(folder / target);
            if (said.code == 0) EXPECT_TRUE(is_there) << what;
            const bool is_old = is_there && read(target) == "the old one";
            if (is_old) EXPECT_NE(said.code, 0) << what;
            if (!is_there) EXPECT_FALSE(has_old) << what;
            if (is_there && !is_old) EXPECT_TRUE(is_whole(target)) << what << ": " << target;
        }
        if (signal != SIGKILL) EXPECT_EQ(all_unresolved(), "") << what;
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().filename().string().starts_with(".chiaro-")) fs::remove(entry);
    }
};

TEST_F(Interruption, CtrlCAtAnyMoment) { interrupt_all(SIGINT); }
TEST_F(Interruption, BeingKilledAtAnyMoment) { interrupt_all(SIGKILL); }

TEST_F(Interruption, AFileSizeLimitIsOneSentence) {
    prepare_input();
    before_start = [] {
        const rlimit limit{512, 512};
        setrlimit(RLIMIT_FSIZE, &limit);
    };
    for (const Command& command : commands()) {
        if (command.arguments.find("in.nrrd") != std::string::npos) continue;  // the limit holds for memory files too
        const Said said = run(command.arguments);
        if (command.targets[0] == "c.json") {
            EXPECT_TRUE(said.code == 0 || said.code == 4) << said.err;
            continue;
        }
        EXPECT_EQ(said.code, 4) << command.arguments << said.err;
        EXPECT_TRUE(said.err.find("cannot write '" + command.targets[0].substr(0, 1)) != std::string::npos) << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
        EXPECT_FALSE(fs::exists(folder / command.targets[0])) << command.arguments;
        EXPECT_EQ(all_unresolved(), "");
    }
}

TEST_F(Interruption, AFullDiskIsOneSentence) {
    const fs::path disk = folder / "disk";
    fs::create_directory(disk);
    if (mount("none", disk.c_str(), "tmpfs", 0, "size=16k") != 0) GTEST_SKIP() << "needs the right to mount";
    std::ofstream(disk / "old.png") << "the old one";
    for (const std::string& arguments :
         {std::string("render sample:menger:16 --size 256x192 --quiet -o disk/old.png"),
          std::string("render sample:menger:16 --size 256x192 --quiet -o disk/new.exr"),
          std::string("sample ball --size 64 -o disk/new.nrrd"),
          std::string("illuminate sample:ball:64 --lighting spao --quiet -o disk/new.nrrd")}) {
        const Said said = run(arguments);
        EXPECT_EQ(said.code, 4) << arguments;
        EXPECT_NE(said.err.find("No space left on device"), said.err.npos) << said.err;
        EXPECT_EQ(std::distance(fs::directory_iterator(disk), {}), 1) << arguments;
        EXPECT_EQ(read("disk/old.png"), "the old one");
    }
    // A cache is a help: without it the picture is made all the same.
    const Said said = run(
        "render sample:menger:24 --size 32x24 --lighting histogram --hist-radius 4 --hist-clusters 256 --cache disk -o "
        "p.png");
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_NE(said.err.find("are not kept"), said.err.npos) << said.err;
    umount(disk.c_str());
}

TEST_F(Interruption, StandardOutputThatIsFullIsTold) {
    for (const char* arguments : {"info sample:ball:16 --json", "--list-options", "sample --list"}) {
        const std::string line =
            fmt::format("cd {}; {} {} >/dev/full 2>.err", folder.string(), built("chiaro"), arguments);
        const int status = std::system(line.c_str());
        EXPECT_EQ(WEXITSTATUS(status), 4) << arguments;
        const std::string said = read(".err");
        EXPECT_TRUE(said.starts_with("chiaro: ") && std::count(said.begin(), said.end(), '\n') == 1) << said;
    }
}

TEST_F(Interruption, AFolderThatCannotBeWrittenTo) {
    const fs::path locked = folder / "locked";
    fs::create_directory(locked);
    std::ofstream(locked / "old.png") << "the old one";
    fs::permissions(folder, fs::perms::all);
    fs::permissions(locked,
                    fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
    before_start = [] {  // root may write anywhere
        constexpr unsigned nobody = 65534;
        if (geteuid() == 0 && (setgroups(0, nullptr) != 0 || setgid(nobody) != 0 || setuid(nobody) != 0)) _exit(126);
    };
    if (run("--version").code != 0) GTEST_SKIP() << "the tool lies where only its owner can start it";
    for (const char* name : {"locked/old.png", "locked/new.exr"}) {
        const Said said = run(fmt::format("render sample:ball:16 --size 16x16 -o {}", name));
        EXPECT_EQ(said.code, 4) << said.err;
        EXPECT_EQ(said.err, fmt::format("chiaro: {}: the folder locked cannot be written to\n", name));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(locked), {}), 1);
    EXPECT_EQ(read("locked/old.png"), "the old one");
    fs::permissions(locked, fs::perms::all);
}

// The folder goes away between the check and the writing: the picture takes three seconds, however fast the machine.
TEST_F(Interruption, AFolderThatVanishes) {
    fs::create_directory(folder / "gone");
    const pid_t child = start(
        "render sample:ball:8 --size 256x256 --lighting reference --reference-rays 65536 --reference-time 3 --quiet -o "
        "gone/a.png");
    std::this_thread::sleep_for(1s);
    fs::remove_all(folder / "gone");
    const Said said = ended(child);
    EXPECT_EQ(said.code, 4) << said.err;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
}

// Every voxel is 7: a value that is not there any more would be seen.
TEST_F(Interruption, AnInputThatVanishesOrShrinks) {
    constexpr std::size_t n = 256;
    const std::string header =
        fmt::format("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {0} {0} {0}\nencoding: raw\n\n", n);
    for (const std::string name : {"in.nrrd", "in_256x256x256_uint8.raw"})
        for (int i = 0; i < 8; ++i) {
            {
                std::ofstream file(folder / name, std::ios::binary);
                if (name == "in.nrrd") file << header;
                file << std::string(n * n * n, '\7');
            }
            const pid_t child = start(fmt::format("info {} --json --quiet", name));
            std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
            i % 2 ? fs::resize_file(folder / name, n * n * 10) : void(fs::remove(folder / name));
            const Said said = ended(child);
            ASSERT_TRUE(said.code == 0 || said.code == 3) << said.code << said.err;
            if (said.code == 0) EXPECT_EQ(nlohmann::json::parse(said.out)["range"], nlohmann::json({7.0, 7.0}));
            if (said.code == 3) EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
            if (said.code == 3) EXPECT_NE(said.err.find(name), said.err.npos) << said.err;
        }
}

TEST_F(Interruption, StandardInput) {
    prepare_input();
    const auto shell = [&](const std::string& line) {
        const int status = std::system(fmt::format("cd {}; ({}) >.out 2>.err", folder.string(), line).c_str());
        return Said{WEXITSTATUS(status), read(".out"), read(".err")};
    };
    const std::string tool = built("chiaro");
    const Said whole = shell("cat in.nrrd | " + tool + " info - --json");
    EXPECT_EQ(whole.code, 0) << whole.err;
    EXPECT_EQ(nlohmann::json::parse(whole.out)["dimensions"], nlohmann::json({64, 64, 64}));
    EXPECT_EQ(shell(tool + " render - --size 16x16 -o p.png <in.nrrd").code, 0);
    for (const char* bytes : {"head -c 9000 in.nrrd", "true", "head -c 3 in.nrrd", "echo NRRD0004", "cat p.png"}) {
        const Said said = shell(std::string(bytes) + " | " + tool + " info -");
        EXPECT_EQ(said.code, 3) << bytes;
        EXPECT_TRUE(said.err.starts_with("chiaro: cannot read 'standard input': ")) << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    }
    EXPECT_EQ(shell(tool + " info - <&-").code, 3);
}

TEST_F(Interruption, WhileStandardInputWaits) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    before_start = [&] { dup2(ends[0], STDIN_FILENO), close(ends[1]); };
    const pid_t child = start("info -");
    ASSERT_EQ(::write(ends[1], "NRRD0004\n", 9), 9);
    int unread = 0;
    do std::this_thread::sleep_for(5ms);
    while (ioctl(ends[0], FIONREAD, &unread) == 0 && unread > 0 && !has_ended(child));
    kill(child, SIGINT);
    const Said said = ended(child);
    EXPECT_EQ(said.code, 130);
    EXPECT_EQ(said.err, "chiaro: interrupted\n");
    close(ends[0]), close(ends[1]);
}

}  // namespace
