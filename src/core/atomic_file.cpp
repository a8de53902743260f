#include "core/atomic_file.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace chiaro {
AtomicFile::AtomicFile(std::filesystem::path path, unsigned mode) : path_(std::move(path)) {
    struct stat existing {};
    if (stat(path_.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode))
        fail(S_ISDIR(existing.st_mode) ? EISDIR : EINVAL);  // renaming over a device would replace it
    const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
    if (access("/proc/self/fd", X_OK) == 0)  // through which it gets its name
        descriptor_ = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
    if (descriptor_ < 0)
        take_name([&] {
            descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
            return descriptor_ >= 0;
        });
}

void AtomicFile::take_name(const std::function<bool()>& take) {
    for (int attempt = 0;; ++attempt) {
        temporary_ = path_.parent_path() / (".chiaro-" + std::to_string(getpid()) + "-" + std::to_string(attempt));
        if (take()) return;
        if (errno == EEXIST && attempt < 1000) continue;
        temporary_.clear();
        fail(errno);
    }
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
    is_flushed_ = false;
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR) fail(errno);
        if (written > 0) bytes = bytes.subspan(std::size_t(written));
    }
}

void AtomicFile::write_past_cache(std::span<const std::byte> bytes) {
    constexpr std::size_t block = 4096;
    const int flags = fcntl(descriptor_, F_GETFL);
    std::size_t whole = bytes.size() / block * block;
    if (fcntl(descriptor_, F_SETFL, flags | O_DIRECT) == 0) {
        while (whole > 0) {
            const ssize_t written = ::write(descriptor_, bytes.data(), whole);
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) break;  // the other way may do it, or tell why not
            bytes = bytes.subspan(std::size_t(written)), whole -= std::size_t(written);
            if (std::size_t(written) % block != 0) break;
        }
        if (fcntl(descriptor_, F_SETFL, flags) != 0) fail(errno);
    }
    write(bytes);
}

void AtomicFile::flush() {
    if (!is_flushed_ && fsync(descriptor_) != 0) fail(errno);
    is_flushed_ = true;
}

void AtomicFile::commit() {
    flush();
    commit_unflushed();
}

void AtomicFile::commit_unflushed() {
    const auto link_to = [&](const std::filesystem::path& name) {
        const std::string nameless = "/proc/self/fd/" + std::to_string(descriptor_);
        return linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    };
    if (temporary_.empty() && !link_to(path_))  // nothing can take another file's name but a rename
        take_name([&] { return link_to(temporary_); });
    if (close(std::exchange(descriptor_, -1)) != 0) fail(errno);
    if (!temporary_.empty() && rename(temporary_.c_str(), path_.c_str()) != 0) fail(errno);
    temporary_.clear();
}

void AtomicFile::fail(int error_number) const {
    throw Error(ErrorCode::output,
                "cannot write '" + path_.string() + "': " + std::generic_category().message(error_number));
}

}  // namespace chiaro
