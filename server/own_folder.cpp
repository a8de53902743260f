#include "own_folder.h"

#include <chiaro/error.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view prefix = "chiaro-view-";

/// An open folder, locked; -1 where it is no folder of this user's, or locked by another program.
int lock_folder(const fs::path& folder) {
    const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    struct stat status {};
    if (opened >= 0 && fstat(opened, &status) == 0 && status.st_uid == geteuid() &&
        flock(opened, LOCK_EX | LOCK_NB) == 0)
        return opened;
    if (opened >= 0) close(opened);
    return -1;
}

}  // namespace

std::pair<fs::path, int> make_own_folder(const fs::path& parent) {
    std::string name = (parent / prefix).string() + "XXXXXX";
    if (!mkdtemp(name.data())) throw Error(ErrorCode::output, fmt::format("{}: cannot be made", name));
    return {name, lock_folder(name)};
}

std::vector<std::pair<fs::path, int>> remove_left_behind(const fs::path& parent,
                                                         const std::function<bool(const fs::path&)>& is_kept) {
    std::vector<std::pair<fs::path, int>> kept;
    constexpr auto new_for = std::chrono::minutes(1);  // it may be about to be locked
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(parent, ignored)) {
        if (!entry.path().filename().string().starts_with(prefix)) continue;
        const bool is_wanted = is_kept && is_kept(entry.path());
        const auto age = fs::file_time_type::clock::now() - fs::last_write_time(entry.path(), ignored);
        if (age < new_for && !is_wanted) continue;
        const int lock = lock_folder(entry.path());
        if (lock < 0) continue;
        if (is_wanted) {
            kept.emplace_back(entry.path(), lock);
            continue;
        }
        fs::remove_all(entry.path(), ignored);
        close(lock);
    }
    return kept;
}

}  // namespace chiaro::server
