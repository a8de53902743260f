#include "core/truncated_file.h"
#include "decode/zarr_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <utility>

namespace chiaro::decode {
namespace {

constexpr int to_a_folder = O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

/// An open descriptor.
class OpenFile {
public:
    explicit OpenFile(int number) : number_(number) {}
    OpenFile(OpenFile&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    OpenFile& operator=(OpenFile&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~OpenFile() {
        if (number_ >= 0) close(number_);
    }
    int number() const { return number_; }
    void read(std::uint64_t offset, std::span<std::byte> to) const {
        for (std::size_t done = 0; done < to.size();) {
            const ssize_t n = pread(number_, to.data() + done, to.size() - done, off_t(offset + done));
            if (n < 0) refuse("reading it fails half-way");
            if (n == 0) refuse(was_cut);
            done += std::size_t(n);
        }
    }

private:
    int number_;
};

class ZarrFolder final : public ZarrStore {
public:
    explicit ZarrFolder(const std::string& path) : root_(open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)) {
        if (root_.number() < 0) refuse("is a folder that cannot be opened");
    }
    std::optional<std::uint64_t> read(const std::string& path, FilePart part,
                                      std::vector<std::byte>& to) const override;
    std::vector<std::string> names(const std::string& path) const override;
    bool lists_names() const override { return true; }

private:
    std::optional<OpenFile> open_last(const std::string& path, int flags) const;

    OpenFile root_;
};

std::optional<OpenFile> ZarrFolder::open_last(const std::string& path, int flags) const {
    check(path);
    OpenFile folder(-1);
    for (std::size_t begin = 0;;) {
        const std::size_t end = path.find('/', begin);
        const std::string name = path.substr(begin, end - begin);
        const int at = folder.number() < 0 ? root_.number() : folder.number();
        OpenFile next(openat(at, name.c_str(), end == path.npos ? flags : O_PATH | to_a_folder));
        if (next.number() < 0) {
            const int why = errno;
            struct stat status {};
            if (fstatat(at, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(status.st_mode))
                refuse(fmt::format("has at '{}' a symbolic link, which is not followed", path.substr(0, end)));
            if (why == ENOENT || why == ENOTDIR) return {};
            refuse(fmt::format("has '{}', which cannot be opened", path));
        }
        if (end == path.npos) return next;
        folder = std::move(next);
        begin = end + 1;
    }
}

std::optional<std::uint64_t> ZarrFolder::read(const std::string& path, FilePart part,
                                              std::vector<std::byte>& to) const {
    const auto file = open_last(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (!file) return {};
    struct stat status {};
    if (fstat(file->number(), &status) != 0 || !S_ISREG(status.st_mode))
        refuse(fmt::format("has at '{}' something that is no regular file", path));
    const auto size = std::uint64_t(status.st_size);
    if (part.kind == FilePart::Kind::all) {
        if (size > part.bytes)
            refuse(fmt::format("has a '{}' of {} bytes where at most {} can be", path, size, part.bytes));
        part.bytes = size;
    }
    part.bytes = part.kind == FilePart::Kind::last ? std::min(part.bytes, size) : part.bytes;
    const std::uint64_t first = part.kind == FilePart::Kind::last ? size - part.bytes : part.first;
    if (first > size || part.bytes > size - first)
        refuse("has a chunk that would lie outside of its file: it was cut, or its index is damaged");
    to.resize(part.bytes);
    file->read(first, to);
    return size;
}

std::vector<std::string> ZarrFolder::names(const std::string& path) const {
    constexpr std::size_t most = 10000;
    auto folder = open_last(path.empty() ? "." : path, O_RDONLY | to_a_folder);
    if (!folder) return {};
    const int number = dup(folder->number());
    DIR* const entries = number < 0 ? nullptr : fdopendir(number);
    std::vector<std::string> names;
    while (const dirent* entry = entries ? readdir(entries) : nullptr) {
        if (names.size() == most) break;
        if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
    }
    if (entries) closedir(entries);
    std::ranges::sort(names, {}, [](const std::string& name) { return std::pair(name.size(), name); });
    return names;
}

}  // namespace

std::unique_ptr<ZarrStore> open_zarr_folder(const std::string& path) { return std::make_unique<ZarrFolder>(path); }

}  // namespace chiaro::decode
