// Stands in for chiaro-decode in isolation_test.cpp: limits itself as the real one does, then does what the first line
// of the "volume" says, and tells how far it came.
#include "decode/limits.h"
#include "decode/output.h"
#include "fetch/limits.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <thread>
#include <vector>

namespace {

using namespace chiaro;
extern "C" char** environ;

int start_program() {
    char* words[] = {const_cast<char*>("/bin/true"), nullptr};
    pid_t child = 0;
    errno = posix_spawn(&child, words[0], nullptr, nullptr, words, environ);
    return errno ? -1 : 0;
}

int send_datagram() {
    sockaddr_in to{};
    to.sin_family = AF_INET, to.sin_port = htons(9), to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int s = socket(AF_INET, SOCK_DGRAM, 0);
    return s < 0 ? -1 : int(sendto(s, "x", 1, 0, reinterpret_cast<sockaddr*>(&to), sizeof to));
}

int connect_somewhere() {
    sockaddr_in to{};
    to.sin_family = AF_INET, to.sin_port = htons(9), to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return connect(STDIN_FILENO, reinterpret_cast<sockaddr*>(&to), sizeof to);
}

int start_thread() {
    try {
        std::thread([] {}).join();
        return 0;
    } catch (const std::system_error& error) {
        errno = error.code().value();
        return -1;
    }
}

int map_as_code() {
    return mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED
               ? -1
               : 0;
}

/// What the kernel must refuse: each returns -1 then.
const std::map<std::string, int (*)(const char* victim)> deeds{
    {"create", [](const char* file) { return open((std::string(file) + ".new").c_str(), O_WRONLY | O_CREAT, 0600); }},
    {"overwrite", [](const char* file) { return open(file, O_WRONLY); }},
    {"empty", [](const char* file) { return truncate(file, 0); }},
    {"remove", [](const char* file) { return unlink(file); }},
    {"rename", [](const char* file) { return rename(file, (std::string(file) + ".new").c_str()); }},
    {"make folder", [](const char* file) { return mkdir((std::string(file) + ".new").c_str(), 0700); }},
    {"link", [](const char* file) { return symlink("/etc/passwd", (std::string(file) + ".new").c_str()); }},
    {"open up", [](const char* file) { return chmod(file, 0777); }},
    {"read", [](const char* file) { return open(file, O_RDONLY); }},
    {"look around", [](const char*) { return open("/", O_RDONLY | O_DIRECTORY); }},
    {"socket", [](const char*) { return socket(AF_UNIX, SOCK_STREAM, 0); }},
    {"internet", [](const char*) { return socket(AF_INET, SOCK_STREAM, 0); }},
    {"connect", [](const char*) { return connect_somewhere(); }},
    {"datagram", [](const char*) { return send_datagram(); }},
    {"program", [](const char*) { return start_program(); }},
    {"fork", [](const char*) { return int(fork()); }},
    {"thread", [](const char*) { return start_thread(); }},
    {"code", [](const char*) { return map_as_code(); }},
    {"signal the parent", [](const char*) { return kill(getppid(), SIGUSR1); }},
    {"write without end", [](const char*) { return ftruncate(3, std::int64_t(1) << 40); }}};

/// What the parent must put up with.
const std::map<std::string, void (*)()> ends{
    {"spin",
     [] {
         volatile std::uint64_t i = 0;
         for (;;) i = i + 1;
     }},
    {"sleep", [] { sleep(1000); }},
    {"ignore all",
     [] {
         for (int s = 1; s < 32; ++s) signal(s, SIG_IGN);
         sleep(1000);
     }},
    {"crash", [] { raise(SIGSEGV); }},
    {"abort", [] { std::abort(); }},
    {"take memory",
     [] {
         std::vector<std::unique_ptr<char[]>> all;  // not touched: the limit is on addresses
         for (;;) all.push_back(std::make_unique_for_overwrite<char[]>(std::size_t(64) << 20));
     }},
    {"take one piece", [] { std::vector<char> all(std::size_t(1) << 40); }}};

/// What it says of where its 64³ bytes lie, in the place of voxels.
const std::map<std::string, VoxelsInFile (*)(const char* file)> places{
    {"place elsewhere", [](const char*) { return VoxelsInFile{"/proc/self/exe"}; }},
    {"place above", [](const char* file) { return VoxelsInFile{std::filesystem::path(file).parent_path() / ".."}; }},
    {"place beyond the end", [](const char* file) { return VoxelsInFile{file}; }},
    {"place far beyond", [](const char* file) {
         return VoxelsInFile{file, ~std::uint64_t(0)};
     }}};

/// Serves chunks of 32³ voxels, each of which holds the number of its chunk; at the last one it does what is said.
int serve(const std::string& deed, decode::Output& output) {
    Volume header;
    header.dimensions = {64, 64, 64};
    output.succeed(header, {{{64, 64, 64}, {32, 32, 32}, {}}});
    constexpr std::size_t bytes = 32 * 32 * 32;
    void* const window = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, 3, 0);
    for (int level = 0, x = 0, y = 0, z = 0; std::cin >> level >> x >> y >> z;) {
        if (const auto end = ends.find(deed); end != ends.end() && x + y + z == 3) end->second();
        std::memset(window, x + 2 * y + 4 * z, bytes);
        output.chunk(true);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const bool serves = argc == 8;
    if (argc != 7 && !serves) return 2;
    std::string deed;
    std::getline(std::ifstream(argv[2]), deed);
    decode::Limits limits{std::strtoull(argv[4], nullptr, 10), unsigned(std::strtoul(argv[5], nullptr, 10)), serves};
    for (const std::string who : {"as fetcher: ", "as reader of Zarr: "}) {
        if (!deed.starts_with(who)) continue;
        deed.erase(0, who.size());
        if (who[3] == 'f')
            limits = fetch::limits_with("");
        else
            limits.permissions.reads_all = false;
    }
    decode::limit_this_process(limits);
    decode::Output output(0);
    try {
        if (serves) return serve(deed, output);
        if (const auto end = ends.find(deed); end != ends.end()) end->second();
        if (const auto place = places.find(deed); place != places.end()) {
            const Volume header = {.dimensions = {64, 64, 64}};
            output.lie_at(header, place->second(argv[2]));
            output.succeed(header);
            return 0;
        }
        const int result = deeds.at(deed)(argv[2]);
        output.fail(result < 0 ? "could not " + deed + ": " + std::strerror(errno) : "DID " + deed);
    } catch (const std::bad_alloc&) {
        output.fail("not enough memory");
    }
    return 0;
}
