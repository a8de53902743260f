// Runs the built tool and keeps what it said.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>

#include "places.h"

struct Said {
    int code = -1;
    std::string out, err;
};

/// A test with a folder of its own.
class FolderTest : public testing::Test {
protected:
    std::filesystem::path folder = std::filesystem::temp_directory_path() / ("chiaro-tool-" + std::to_string(getpid()));

    void SetUp() override { std::filesystem::create_directories(folder); }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::string read(const std::string& name) const {
        std::ifstream stream(folder / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(read(name)); }

    void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }

    /// The files in the folder, sorted.
    std::string files() const {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
        std::string list;
        for (const auto& name : names) list += (list.empty() ? "" : " ") + name;
        return list;
    }
};

/// A test that runs the tool there.
class ToolTest : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        if (!std::filesystem::exists(built("chiaro"))) GTEST_SKIP() << "skipped: the tool was not built";
    }

    /// Runs `chiaro ARGUMENTS`, as a shell reads them, in the folder. A signal is sent, where given, once it has had
    /// that much time of a CPU: it has come as far however busy the machine is.
    Said tool(const std::string& arguments, int signal = 0, std::chrono::milliseconds after = {}) {
        const auto out = folder / ".out", err = folder / ".err";
        const std::string line = "exec " + built("chiaro ") + arguments + " >.out 2>.err";
        const pid_t child = fork();
        if (child == 0) {
            if (chdir(folder.c_str()) == 0) execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
            _exit(127);
        }
        if (signal) {
            while (cpu_time(child) < after && !has_ended(child))
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            kill(child, signal);
        }
        int status = 0;
        waitpid(child, &status, 0);
        const Said said{WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read(".out"), read(".err")};
        std::filesystem::remove(out), std::filesystem::remove(err);
        return said;
    }

    /// Whether nothing is to be waited for: the child, still to be collected, is no more.
    static bool has_ended(pid_t child) {
        siginfo_t info{};
        return waitid(P_PID, id_t(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == child;
    }

private:
    static std::chrono::nanoseconds cpu_time(pid_t process) {
        clockid_t clock;
        timespec time{};
        if (clock_getcpuclockid(process, &clock) == 0) clock_gettime(clock, &time);
        return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
    }
};
