#include <chiaro/error.h>
#include <chiaro/video.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace chiaro {
namespace fs = std::filesystem;
namespace {

std::string program_path() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const std::string program = folder + "/ffmpeg"; !folder.empty() && access(program.c_str(), X_OK) == 0)
            return program;
    return {};
}

}  // namespace

bool has_ffmpeg() { return !program_path().empty(); }

struct VideoWriter::State {
    fs::path path, partial;
    int width, height;
    pid_t child = -1;
    int to_child = -1, from_child = -1;
    std::string said;  ///< by ffmpeg, on its error stream

    ~State() {
        close_pipes();
        if (child > 0) kill(child, SIGKILL), waitpid(child, nullptr, 0);
        std::error_code ignored;
        if (!partial.empty()) fs::remove(partial, ignored);
    }
    void close_pipes() {
        for (int* end : {&to_child, &from_child})
            if (*end >= 0) ::close(std::exchange(*end, -1));
    }

    void start(double fps) {
        const std::string program = program_path();
        if (program.empty())
            throw Error(ErrorCode::output,
                        "films need the program ffmpeg, which is not installed (apt install ffmpeg)");
        std::vector<std::string> words{program, "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt",
                                       "rgb24", "-s", fmt::format("{}x{}", width, height), "-r", fmt::format("{}", fps),
                                       "-i", "pipe:0",
                                       // Players want even sizes and this pixel format.
                                       "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"};
        if (path.extension() != ".webm") words.insert(words.end(), {"-crf", "18"});
        words.push_back("file:" + partial.string());
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        int in[2], out[2];
        if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0)
            throw Error(ErrorCode::output, "ffmpeg cannot be started: no pipe");
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, in[0], 0);
        posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, out[1], 2);
        const int failed = posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(in[0]), ::close(out[1]);
        to_child = in[1], from_child = out[0];
        fcntl(to_child, F_SETFL, O_NONBLOCK), fcntl(from_child, F_SETFL, O_NONBLOCK);
        if (failed)
            child = -1,
            throw Error(ErrorCode::output, fmt::format("ffmpeg cannot be started: {}", std::strerror(failed)));
    }

    void listen() {
        char text[4096];
        for (ssize_t n; (n = ::read(from_child, text, sizeof text)) > 0;) said.append(text, std::size_t(n));
        if (said.size() > 4000) said.erase(0, said.size() - 4000);
    }

    [[noreturn]] void fail() {
        listen();
        while (!said.empty() && said.back() == '\n') said.pop_back();
        throw Error(ErrorCode::output, fmt::format("{}: ffmpeg failed: {}", path.string(),
                                                   said.empty() ? "it ended" : said.substr(said.rfind('\n') + 1)));
    }

    /// A pipe whose reader is gone is an error here, not a signal.
    void put(const std::uint8_t* bytes, std::size_t count) {
        sigset_t pipe_signal, before;
        sigemptyset(&pipe_signal), sigaddset(&pipe_signal, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
        bool is_broken = false;
        while (count > 0 && !is_broken) {
            const ssize_t written = ::write(to_child, bytes, count);
            if (written > 0) bytes += written, count -= std::size_t(written);
            if (written < 0 && errno == EAGAIN) {
                pollfd ends[2]{{to_child, POLLOUT, 0}, {from_child, POLLIN, 0}};
                poll(ends, 2, 1000);
                listen();
            } else if (written < 0 && errno != EINTR) {
                is_broken = true;
            }
        }
        const timespec now{};
        if (is_broken) sigtimedwait(&pipe_signal, nullptr, &now);
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
        if (is_broken) fail();
    }
};

VideoWriter::VideoWriter(const fs::path& path, int width, int height, double fps) : state_(std::make_unique<State>()) {
    const std::string ending = path.extension().string();
    if (ending != ".mp4" && ending != ".mkv" && ending != ".webm")
        throw Error(ErrorCode::usage, fmt::format("{}: a film's name must end in .mp4, .mkv or .webm", path.string()));
    state_->path = path, state_->width = width, state_->height = height;
    state_->partial = path.parent_path() / fmt::format(".{}.partial-{}{}", path.stem().string(), getpid(), ending);
    state_->start(fps);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const Image& image) {
    if (image.width != state_->width || image.height != state_->height)
        throw Error(ErrorCode::usage, "a film's pictures must be of one size");
    if (!image.has_alpha) return state_->put(image.pixels.data(), image.pixels.size());
    std::vector<std::uint8_t> rgb(std::size_t(3) * image.width * image.height);
    for (std::size_t i = 0; i < rgb.size() / 3; ++i)
        for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = image.pixels[4 * i + c];
    state_->put(rgb.data(), rgb.size());
}

void VideoWriter::finish() {
    State& s = *state_;
    ::close(std::exchange(s.to_child, -1));
    int status = 0;
    for (pid_t ended = 0; ended == 0; ended = waitpid(s.child, &status, WNOHANG)) {
        pollfd end{s.from_child, POLLIN, 0};
        poll(&end, 1, 20);
        s.listen();
    }
    s.child = -1;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) s.fail();
    std::error_code error;
    fs::rename(s.partial, s.path, error);
    if (error) throw Error(ErrorCode::output, fmt::format("{}: {}", s.path.string(), error.message()));
    s.partial.clear();
}

}  // namespace chiaro
