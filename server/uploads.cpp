#include "uploads.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/user_cache.h"
#include "own_folder.h"
#include "token.h"

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t disk_reserve = 64 << 20;  ///< bytes that are left free
constexpr std::size_t max_name = 200;

/// The cache lies on a disk, temporary files often in memory.
fs::path parent_folder() {
    const fs::path cache = user_cache();
    std::error_code error;
    if (!cache.empty()) fs::create_directories(cache, error);
    return cache.empty() || error ? fs::temp_directory_path() : cache;
}

/// A name of one file: without folders, control characters or a dot in front.
std::string plain_name(const std::string& name) {
    std::string plain;
    for (const char c : name) plain += c == '/' || c == '\\' || static_cast<unsigned char>(c) < 32 ? '-' : c;
    plain.erase(0, plain.find_first_not_of(".-"));
    if (plain.size() > max_name) plain.erase(0, plain.size() - max_name);
    if (plain.empty()) throw Error(ErrorCode::usage, "name: must name a file");
    return plain;
}

std::string told(std::uint64_t bytes) {
    const double kib = double(bytes) / 1024;
    return kib < 1024          ? fmt::format("{:.1f} KiB", kib)
           : kib < 1024 * 1024 ? fmt::format("{:.1f} MiB", kib / 1024)
                               : fmt::format("{:.1f} GiB", kib / 1024 / 1024);
}

bool is_header(const fs::path& file) { return file.extension() == ".nhdr" || file.extension() == ".mhd"; }

}  // namespace

Uploads::Uploads(std::uint64_t max_bytes, const std::vector<fs::path>& kept) : max_bytes_(max_bytes) {
    const fs::path parent = parent_folder();
    owned_ = remove_left_behind(parent, [&](const fs::path& folder) {
        return std::any_of(kept.begin(), kept.end(), [&](const fs::path& file) {
            return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
        });
    });
    owned_.push_back(make_own_folder(parent));
    folder_ = owned_.back().first;
}

Uploads::~Uploads() {
    remove();
    for (const auto& [folder, lock] : owned_)
        if (lock >= 0) close(lock);
}

void Uploads::remove() {
    std::error_code ignored;
    for (const auto& [folder, lock] : owned_) fs::remove_all(folder, ignored);
}

std::vector<fs::path> Uploads::folders() const {
    std::vector<fs::path> all;
    for (const auto& [folder, lock] : owned_) all.push_back(folder);
    return all;
}

void Uploads::refuse_size() const {
    throw Error(ErrorCode::usage, fmt::format("A volume may have at most {} (--max-upload).", told(max_bytes_)));
}

void Uploads::refuse_count() const {
    throw Error(ErrorCode::usage, fmt::format("A folder may have at most {} files.", max_upload_files));
}

void Uploads::check_disk(std::uint64_t bytes) const {
    std::error_code error;
    const auto space = fs::space(folder_, error);
    if (!error && space.available < bytes + disk_reserve)
        throw Error(ErrorCode::output,
                    fmt::format("The disk has no room: {} are sent, {} are free.", told(bytes), told(space.available)));
}

void Uploads::check_room(std::uint64_t bytes, std::uint64_t files) const {
    if (bytes > max_bytes_) refuse_size();
    if (files > max_upload_files) refuse_count();
    check_disk(bytes);
}

fs::path Uploads::begin(const std::string& volume, const std::string& name, std::uint64_t bytes) {
    const std::string plain = plain_name(name);
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(volume);
    Sent sent = found == sent_.end() ? Sent() : found->second;
    if (bytes > max_bytes_ || sent.bytes > max_bytes_ - bytes) refuse_size();
    if (sent.files >= max_upload_files) refuse_count();
    check_disk(bytes);
    std::error_code error;
    if (sent.folder.empty()) {
        sent.folder = folder_ / random_key();
        if (!fs::create_directory(sent.folder, error))
            throw Error(ErrorCode::output, "What is sent cannot be kept: " + error.message() + ".");
    }
    fs::path file = sent.folder / plain;
    for (int n = 2; fs::exists(file, error); ++n) file = sent.folder / fmt::format("{}-{}", n, plain);
    sent.bytes += bytes, ++sent.files;
    sent_[volume] = sent;
    return file;
}

void Uploads::abandon(const std::string& volume, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(volume);
    if (found == sent_.end()) return;
    found->second.bytes -= std::min(bytes, found->second.bytes);
    found->second.files -= found->second.files > 0;
}

std::string Uploads::to_open(const std::string& volume) const {
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(volume);
    if (found == sent_.end() || found->second.files == 0)
        throw Error(ErrorCode::usage, "uploaded: nothing was sent under this name");
    std::vector<fs::path> files, headers;
    for (const auto& entry : fs::directory_iterator(found->second.folder)) {
        files.push_back(entry.path());
        if (is_header(entry.path())) headers.push_back(entry.path());
    }
    if (headers.size() == 1) return headers.front().string();
    return files.size() == 1 ? files.front().string() : found->second.folder.string();
}

void Uploads::discard(const std::string& volume) {
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(volume);
    if (found == sent_.end()) return;
    std::error_code ignored;
    fs::remove_all(found->second.folder, ignored);
    sent_.erase(found);
}

}  // namespace chiaro::server
