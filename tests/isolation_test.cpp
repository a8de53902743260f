// What the helper program may do on this machine, should a file ever take it over: read, compute and answer.
#include "volume_files.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <sys/wait.h>

#include <chrono>

using namespace chiaro;
using namespace volume_files;

namespace {

class Isolation : public testing::Test {
protected:
    const Folder folder;
    ReadOptions options;

    void SetUp() override {
        setenv("CHIARO_DECODE", built("misbehaving_decoder").c_str(), 1);
        options.max_bytes = 64 << 20;
        options.seconds = 20;
        options.stall_seconds = 10;
    }

    /// The sentence that the program makes of a helper that does this.
    std::string after(const std::string& deed) {
        const std::string file = folder.write("task.nrrd", deed + "\n");
        Progress progress;
        try {
            read_volume(file, options, progress);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input) << deed;
            EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a zombie of: " << deed;
            EXPECT_EQ(content_of(file), deed + "\n");
            EXPECT_EQ(std::distance(fs::directory_iterator(folder.name()), {}), 1) << "files after: " << deed;
            return error.what();
        }
        return "a volume";
    }
};

TEST_F(Isolation, NothingIsWrittenSentOrStarted) {
    for (const std::string deed :
         {"create", "overwrite", "empty", "remove", "rename", "make folder", "link", "open up", "socket", "internet",
          "datagram", "connect", "program", "fork", "thread", "code", "signal the parent", "write without end"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("could not " + deed), said.npos) << said;
    }
}

TEST_F(Isolation, WhatReadsZarrSeesItsStoreAlone) {
    for (const std::string deed : {"read", "look around", "create", "internet", "connect", "program"}) {
        const std::string said = after("as reader of Zarr: " + deed);
        EXPECT_NE(said.find("could not " + deed), said.npos) << said;
    }
}

TEST_F(Isolation, WhatFetchesSeesNoFileAndStartsNothing) {
    for (const std::string deed : {"read", "look around", "create", "overwrite", "remove", "rename", "make folder",
                                   "open up", "socket", "program", "fork", "code", "signal the parent"}) {
        const std::string said = after("as fetcher: " + deed);
        EXPECT_NE(said.find("could not " + deed), said.npos) << said;
    }
    for (const std::string deed : {"internet", "thread"}) {
        const std::string said = after("as fetcher: " + deed);
        EXPECT_NE(said.find("DID " + deed), said.npos) << said;
    }
}

TEST_F(Isolation, VoxelsAreReadFromTheFolderOfTheFileAlone) {
    for (const std::string deed : {"place elsewhere", "place above"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("none of its"), said.npos) << said;
    }
    for (const std::string deed : {"place beyond the end", "place far beyond"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("more voxels than there are"), said.npos) << said;
    }
}

TEST_F(Isolation, MemoryIsLimited) {
#if !defined(__SANITIZE_ADDRESS__)  // which cannot be: it maps terabytes
    for (const std::string deed : {"take memory", "take one piece"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("not enough memory"), said.npos) << said;
    }
#endif
}

TEST_F(Isolation, TimeIsLimited) {
    options.seconds = 1;
    EXPECT_NE(after("spin").find("more than 1 seconds"), std::string::npos);
    options.seconds = 300;  // were it this limit that ends it, the message would say so
    options.stall_seconds = 1;
    for (const std::string deed : {"sleep", "ignore all"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("came to a halt"), said.npos) << said;
    }
}

// Should the parent sleep (or be stopped), the kernel ends the helper.
TEST_F(Isolation, CpuTimeIsLimitedByTheKernel) {
    options.seconds = 1;  // gives the helper two
    Progress progress;
    const std::string file = folder.write("task.nrrd", "spin\n");
    const pid_t child = fork();
    if (child == 0) {
        const std::string program = built("misbehaving_decoder");
        const int null_for_voxels = open("/dev/null", O_RDWR), null_for_messages = open("/dev/null", O_RDWR);
        dup2(null_for_voxels, 3), dup2(null_for_messages, 4);
        execl(program.c_str(), program.c_str(), "nrrd", file.c_str(), "", "1000000", "1", "0", nullptr);
        _exit(127);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) << status;
}

TEST_F(Isolation, ACrashIsOneSentence) {
    for (const std::string deed : {"crash", "abort"}) {
        const std::string said = after(deed);
        EXPECT_NE(said.find("the decoder crashed on it (signal "), said.npos) << said;
        EXPECT_EQ(said.find('\n'), said.npos);
    }
}

}  // namespace
