// Chunks for who asks for them, one after the other.
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <string>
#include <string_view>

#include "decode/chunked.h"
#include "decode/limits.h"

namespace chiaro::decode {
namespace {

/// The next line of the standard input; false at its end.
bool next_line(std::string& received, std::string& line) {
    for (;;) {
        if (const auto end = received.find('\n'); end != std::string::npos) {
            line = received.substr(0, end);
            received.erase(0, end + 1);
            return true;
        }
        char piece[256];
        const ssize_t n = ::read(STDIN_FILENO, piece, sizeof piece);
        if (n <= 0) return false;
        received.append(piece, std::size_t(n));
    }
}

/// The memory file, which has its size from who asks.
std::span<std::byte> map_window() {
    struct stat status {};
    if (fstat(wire::voxels_descriptor, &status) != 0) refuse("has no memory file for its voxels");
    void* mapping =
        mmap(nullptr, std::size_t(status.st_size), PROT_READ | PROT_WRITE, MAP_SHARED, wire::voxels_descriptor, 0);
    if (mapping == MAP_FAILED) refuse(fmt::format("no room for {} MiB of voxels", status.st_size >> 20));
    return {static_cast<std::byte*>(mapping), std::size_t(status.st_size)};
}

struct Request {
    int level = 0;
    std::array<int, 3> chunk{};
};

Request parsed(const std::string& line, const ChunkedFile& file) {
    int numbers[4] = {};
    const char *at = line.data(), *end = at + line.size();
    for (int& number : numbers) {
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc()) refuse("was asked for no chunk");
        at = next + (next < end);
    }
    const Request request{numbers[0], {numbers[1], numbers[2], numbers[3]}};
    bool is_there = request.level >= 0 && std::size_t(request.level) < file.levels().size();
    for (std::size_t axis = 0; is_there && axis < 3; ++axis)
        is_there =
            request.chunk[axis] >= 0 && request.chunk[axis] < file.levels()[std::size_t(request.level)].chunks()[axis];
    if (!is_there) refuse("was asked for a chunk that it has not");
    return request;
}

}  // namespace

void serve(ChunkedFile& file, unsigned cpu_seconds, Output& output) {
    Volume alone;
    if (file.header().moments.count == 1) output.choose_moment(1, alone);
    output.succeed(file.header(), file.levels());
    std::string received, line;
    std::span<std::byte> window;
    while (next_line(received, line)) try {
            limit_cpu_from_now(cpu_seconds);
            if (window.empty()) window = map_window();
            const auto [level, chunk] = parsed(line, file);
            const std::uint64_t bytes = file.levels()[std::size_t(level)].chunk_voxels() * size_of(file.header().type);
            if (bytes > window.size()) refuse("was given too little memory for a chunk");
            output.chunk(file.read(level, chunk, 0, window.first(bytes)));
        } catch (const std::bad_alloc&) {
            output.fail("decoding it takes more memory than is permitted");
        } catch (const std::exception& error) {
            output.fail(error.what());
        }
}

}  // namespace chiaro::decode
