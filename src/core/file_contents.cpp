#include "core/file_contents.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "core/did_you_mean.h"

namespace chiaro {
namespace {

template <class Contents>
Contents contents_of(const std::filesystem::path& path, std::uintmax_t max_bytes, bool cut = false) {
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorCode::input, "cannot read '" + path.string() + "': " + what);
    };
    const auto refuse_by = [&](int error) {
        refuse(std::generic_category().message(error) + (error == ENOENT ? did_you_mean_file(path) : ""));
    };
    struct Opened {
        int file;
        ~Opened() { close(file); }
    };
    // Without O_NONBLOCK a FIFO would be waited for before anything can be asked of it.
    const Opened opened{open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK)};
    struct stat status {};
    if (opened.file < 0 || fstat(opened.file, &status) != 0) refuse_by(errno);
    if (S_ISDIR(status.st_mode)) refuse_by(EISDIR);
    if (!S_ISREG(status.st_mode)) refuse("it is no regular file");
    const auto size = std::uintmax_t(status.st_size);
    if (size > max_bytes && !cut) refuse("is larger than " + std::to_string(max_bytes >> 20) + " MiB");
    Contents contents;
    contents.resize(std::size_t(std::min(size, max_bytes)));
    for (std::size_t done = 0; done < contents.size();) {
        const ssize_t n = read(opened.file, contents.data() + done, contents.size() - done);
        if (n < 0 && errno != EINTR) refuse_by(errno);
        if (n == 0) refuse("it became shorter while it was read");
        if (n > 0) done += std::size_t(n);
    }
    return contents;
}

}  // namespace

std::vector<std::byte> file_bytes(const std::filesystem::path& path, std::uintmax_t max_bytes) {
    return contents_of<std::vector<std::byte>>(path, max_bytes);
}

std::string file_text(const std::filesystem::path& path, std::uintmax_t max_bytes) {
    return contents_of<std::string>(path, max_bytes);
}

std::string file_beginning(const std::filesystem::path& path, std::uintmax_t bytes) {
    return contents_of<std::string>(path, bytes, true);
}

}  // namespace chiaro
