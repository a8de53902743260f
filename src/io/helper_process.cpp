#include "io/helper_process.h"

#include "io/wire.h"

#include <chiaro/error.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

extern char** environ;

namespace chiaro {
namespace {

constexpr std::size_t longest_line = 4 << 20;

std::pair<Descriptor, Descriptor> make_pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw Error(ErrorCode::output, "cannot start the decoder: no more files can be opened");
    return {Descriptor(ends[0]), moved_up(Descriptor(ends[1]))};
}

/// The list of what a new process finds open.
class FileActions {
public:
    FileActions() { posix_spawn_file_actions_init(&actions_); }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
    void open_null(int as, int flags) { posix_spawn_file_actions_addopen(&actions_, as, "/dev/null", flags, 0); }
    void hand_over(int from, int as) { posix_spawn_file_actions_adddup2(&actions_, from, as); }
    const posix_spawn_file_actions_t* get() const { return &actions_; }

private:
    posix_spawn_file_actions_t actions_;
};

}  // namespace

Descriptor::~Descriptor() {
    if (number_ >= 0) close(number_);
}

Descriptor moved_up(Descriptor descriptor) { return Descriptor(fcntl(descriptor.number(), F_DUPFD_CLOEXEC, 10)); }

Descriptor make_memory_file(const char* name) {
    Descriptor file = moved_up(Descriptor(memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING)));
    if (file.number() < 0) throw Error(ErrorCode::output, "cannot make a memory file: no memory or no more files");
    return file;
}

std::pair<Descriptor, Descriptor> make_connection() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw Error(ErrorCode::output, "cannot start the decoder: no more files can be opened");
    return {moved_up(Descriptor(ends[0])), moved_up(Descriptor(ends[1]))};
}

std::filesystem::path find_helper(const std::string& name) {
    std::error_code ignored;
    std::vector<std::filesystem::path> places;
    if (const char* stated = std::getenv(name == "chiaro-fetch" ? "CHIARO_FETCH" : "CHIARO_DECODE"))
        places.emplace_back(stated);
    // Of the library that asks, where it is one: what is loaded into another program brings its helpers along.
    Dl_info library{};
    if (dladdr(reinterpret_cast<const void*>(&find_helper), &library) && library.dli_fname[0] == '/') {
        const auto folder = std::filesystem::path(library.dli_fname).parent_path();
        for (const char* place : {"", "..", "../libexec/chiaro"}) places.push_back(folder / place / name);
    }
    if (const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored); !self.empty()) {
        places.push_back(self.parent_path() / name);
        places.push_back(self.parent_path() / "../libexec/chiaro" / name);
    }
    places.push_back(std::filesystem::path(CHIARO_DECODE_PATH).replace_filename(name));
    for (const auto& place : places)
        if (access(place.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(place, ignored)) return place;
    throw Error(ErrorCode::internal, "the program " + name + " is missing; it belongs beside this one (or name it in " +
                                         (name == "chiaro-fetch" ? "CHIARO_FETCH)" : "CHIARO_DECODE)"));
}

HelperProcess::HelperProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                             const HandedOver& handed_over) {
    auto [reading, writing] = make_pipe();
    FileActions actions;
    const auto hand_over = [&](int number, int as, int flags) {
        if (number >= 0)
            actions.hand_over(number, as);
        else
            actions.open_null(as, flags);
    };
    hand_over(handed_over.standard_input, STDIN_FILENO, O_RDONLY);
    actions.open_null(STDOUT_FILENO, O_WRONLY);
    actions.open_null(STDERR_FILENO, O_WRONLY);
    hand_over(handed_over.voxels, wire::voxels_descriptor, O_RDONLY);
    actions.hand_over(writing.number(), wire::messages_descriptor);
    hand_over(handed_over.fetch, wire::fetch_descriptor, O_RDONLY);
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    if (posix_spawn(&process_, program.c_str(), actions.get(), nullptr, words.data(), environ) != 0)
        throw Error(ErrorCode::output, "cannot start '" + program.string() + "'");
    messages_ = std::move(reading);
}

HelperProcess::~HelperProcess() {
    if (process_ < 0) return;
    kill(process_, SIGKILL);
    ending_signal();
}

bool HelperProcess::take_line(std::string& line) {
    const auto end = received_.find('\n');
    if (end == std::string::npos) return false;
    line = received_.substr(0, end);
    received_.erase(0, end + 1);
    return true;
}

HelperProcess::Event HelperProcess::next(std::string& line, std::chrono::milliseconds patience) {
    if (take_line(line)) return Event::line;
    pollfd waiting{messages_.number(), POLLIN, 0};
    if (poll(&waiting, 1, int(patience.count())) <= 0) return Event::nothing;
    std::array<char, 65536> piece;
    const ssize_t n = read(messages_.number(), piece.data(), piece.size());
    if (n <= 0 || received_.size() > longest_line) return Event::ended;
    received_.append(piece.data(), std::size_t(n));
    return take_line(line) ? Event::line : Event::nothing;
}

int HelperProcess::ending_signal() {
    // It may have closed its pipe, or said too much, without ending: it gets a moment, then it is made to.
    constexpr int tries = 100;
    int status = 0;
    bool stopped_here = false;
    pid_t ended = 0;
    for (int i = 0; ended == 0 || (ended < 0 && errno == EINTR); ++i) {
        if (i == tries) stopped_here = kill(process_, SIGKILL) == 0;
        ended = waitpid(process_, &status, i < tries ? WNOHANG : 0);
        if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(i < 10 ? 1 : 5));
    }
    process_ = -1;
    return ended > 0 && !stopped_here && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

}  // namespace chiaro
