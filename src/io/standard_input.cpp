#include "io/standard_input.h"

#include "io/memory.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <vector>

namespace chiaro {
namespace {

[[noreturn]] void refuse(const std::string& sentence) {
    throw Error(ErrorCode::input, "cannot read standard input: " + sentence);
}

void write_all(int file, const std::byte* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
        const ssize_t n = write(file, bytes + done, size - done);
        if (n <= 0) refuse("there is no memory to keep it");
        done += std::size_t(n);
    }
}

}  // namespace

Descriptor spool_standard_input(const ReadOptions& options, Progress& progress) {
    using Clock = std::chrono::steady_clock;
    const std::uint64_t most = options.max_bytes > 0 ? options.max_bytes : available_memory() / 2;
    Descriptor file = make_memory_file("chiaro standard input");
    std::vector<std::byte> buffer(1 << 20);
    auto last_sign = Clock::now();
    for (std::uint64_t total = 0;;) {
        progress.check();
        pollfd waiting{STDIN_FILENO, POLLIN, 0};
        if (poll(&waiting, 1, 50) <= 0) {
            if (std::chrono::duration<double>(Clock::now() - last_sign).count() > options.stall_seconds)
                refuse(fmt::format("nothing came for {} seconds", options.stall_seconds));
            continue;
        }
        const ssize_t n = read(STDIN_FILENO, buffer.data(), buffer.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) refuse("it is not open");
        if (n == 0) return file;
        total += std::size_t(n);
        if (total > most) refuse(fmt::format("it is longer than {} MiB", most >> 20));
        write_all(file.number(), buffer.data(), std::size_t(n));
        last_sign = Clock::now();
    }
}

}  // namespace chiaro
