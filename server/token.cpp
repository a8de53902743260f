#include "token.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t key_length = 32;

bool is_key(const std::string& text) {
    return text.size() == key_length && text.find_first_not_of("0123456789abcdef") == text.npos;
}

fs::path state_folder() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state == '/') return fs::path(state) / "chiaro";
    if (const char* home = std::getenv("HOME"); home && *home == '/') return fs::path(home) / ".local/state/chiaro";
    return {};
}

/// Nothing unless the file is the user's own and nobody else's.
std::string kept_key(const fs::path& file) {
    const int fd = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) return {};
    struct stat status {};
    std::string text(key_length, '\0');
    const bool is_private =
        fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() && (status.st_mode & 077) == 0;
    const bool is_whole = is_private && read(fd, text.data(), key_length) == ssize_t(key_length);
    close(fd);
    return is_whole && is_key(text) ? text : "";
}

void keep(const fs::path& file, const std::string& key) {
    std::error_code ignored;
    fs::create_directories(file.parent_path(), ignored);
    fs::remove(file, ignored);
    const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (fd < 0) return;
    const bool is_whole = write(fd, key.data(), key.size()) == ssize_t(key.size());
    close(fd);
    if (!is_whole) fs::remove(file, ignored);
}

}  // namespace

std::string random_key() {
    unsigned char bytes[key_length / 2];
    if (getrandom(bytes, sizeof bytes, 0) != ssize_t(sizeof bytes))
        throw Error(ErrorCode::internal, "the system gives no random numbers");
    std::string key;
    for (const unsigned char byte : bytes) key += fmt::format("{:02x}", byte);
    return key;
}

std::string token_for(int port) {
    if (const char* given = std::getenv("CHIARO_VIEW_TOKEN"); given && *given) {
        if (!is_key(given))
            throw Error(ErrorCode::usage, "CHIARO_VIEW_TOKEN: must be 32 hexadecimal digits, 0-9 and a-f");
        return given;
    }
    const fs::path folder = state_folder();
    if (folder.empty()) return random_key();
    const fs::path file = folder / fmt::format("view-{}.token", port);
    std::string key = kept_key(file);
    if (key.empty()) keep(file, key = random_key());
    return key;
}

bool is_same_key(const std::string& a, const std::string& b) {
    unsigned difference = unsigned(a.size() ^ b.size());
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) difference |= unsigned(a[i] ^ b[i]);
    return difference == 0;
}

}  // namespace chiaro::server
