#include "decode/zarr_folder.h"

#include "core/text.h"
#include "core/truncated_file.h"
#include "decode/output.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace chiaro::decode {
namespace {

constexpr int to_a_folder = O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;

}  // namespace

OpenFile::~OpenFile() {
    if (number_ >= 0) close(number_);
}

std::uint64_t OpenFile::size() const {
    struct stat status {};
    return fstat(number_, &status) == 0 ? std::uint64_t(status.st_size) : 0;
}

void OpenFile::read(std::uint64_t offset, std::span<std::byte> to) const {
    for (std::size_t done = 0; done < to.size();) {
        const ssize_t n = pread(number_, to.data() + done, to.size() - done, off_t(offset + done));
        if (n < 0) refuse("reading it fails half-way");
        if (n == 0) refuse(was_cut);
        done += std::size_t(n);
    }
}

ZarrFolder::ZarrFolder(const std::filesystem::path& path)
    : root_(::open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)) {
    if (root_.number() < 0) refuse("is a folder that cannot be opened");
}

std::optional<OpenFile> ZarrFolder::open_last(const std::string& path, int flags) const {
    OpenFile folder(-1);
    for (std::size_t begin = 0;;) {
        const std::size_t end = path.find('/', begin);
        const std::string name = path.substr(begin, end - begin);
        if (name.empty() || name == "..") refuse(fmt::format("names '{}', which leads out of its folder", path));
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

std::optional<OpenFile> ZarrFolder::open(const std::string& path) const {
    auto file = open_last(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    struct stat status {};
    if (file && (fstat(file->number(), &status) != 0 || !S_ISREG(status.st_mode)))
        refuse(fmt::format("has at '{}' something that is no regular file", path));
    return file;
}

std::optional<nlohmann::json> ZarrFolder::json(const std::string& path) const {
    constexpr std::uint64_t most = 16 << 20;
    const auto file = open(path);
    if (!file) return {};
    if (file->size() > most) refuse(fmt::format("has a '{}' of more than {} MiB", path, most >> 20));
    std::string text(file->size(), '\0');
    file->read(0, std::as_writable_bytes(std::span(text)));
    if (is_deeper_than(64, text)) refuse(fmt::format("has a '{}' that is nested too deeply", path));
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object()) refuse(fmt::format("has a '{}' that is no JSON object", path));
    if (const std::string twice = json_contradiction(text); !twice.empty())
        refuse(fmt::format("has a '{}' that {}", path, twice));
    return json;
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

std::string joined(const std::string& folder, const std::string& name) {
    if (folder.empty() || name.empty()) return folder + name;
    return folder + "/" + name;
}

}  // namespace chiaro::decode
