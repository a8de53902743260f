#include "film_store.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdint>

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr auto left_for = std::chrono::hours(24);

/// FNV-1a, 64 bits: the same in every process.
std::uint64_t hash(const std::string& text) {
    std::uint64_t sum = 0xcbf29ce484222325;
    for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    return sum;
}

}  // namespace

FilmStore::FilmStore(fs::path root) : root_(std::move(root)) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(root_, ignored))
        if (fs::file_time_type::clock::now() - fs::last_write_time(entry.path(), ignored) > left_for)
            fs::remove_all(entry.path(), ignored);
}

FilmStore::~FilmStore() { clear(); }

void FilmStore::clear() {
    const std::lock_guard lock(mutex_);
    std::error_code ignored;
    for (const fs::path& folder : made_) fs::remove_all(folder, ignored);
    made_.clear();
}

fs::path FilmStore::folder_of(const std::string& text) {
    const fs::path folder = root_ / fmt::format("{:016x}-{}", hash(text), text.size());
    std::error_code error;
    fs::create_directories(root_, error);
    const bool is_there = mkdir(folder.c_str(), 0700) == 0 || fs::is_directory(fs::symlink_status(folder, error));
    if (!is_there) throw Error(ErrorCode::output, "the film's frames cannot be kept: no folder can be made for them");
    fs::last_write_time(folder, fs::file_time_type::clock::now(), error);
    const std::lock_guard lock(mutex_);
    made_.insert(folder);
    return folder;
}

void FilmStore::remove(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    const std::lock_guard lock(mutex_);
    made_.erase(folder);
}

}  // namespace chiaro::server
