#include "io/http_cache.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include "core/atomic_file.h"
#include "core/byte_size.h"
#include "core/crc32c.h"
#include "core/file_contents.h"
#include "core/text.h"

namespace chiaro {
namespace {

/// The first line; the next ones are what the file is of, the tag and the whole file's size. Then the bytes, and the
/// checksum of all of it.
constexpr std::string_view first_line = "chiaro http 1";

struct KeptFile {
    std::filesystem::path path;
    std::uint64_t bytes = 0;
    std::filesystem::file_time_type used;
};

std::vector<KeptFile> kept_files(const std::filesystem::path& folder) {
    std::vector<KeptFile> files;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        std::error_code gone;  // somebody else makes room, too
        KeptFile file{at->path(), at->file_size(gone), at->last_write_time(gone)};
        if (!gone && at->is_regular_file(gone) && file.path.extension() == HttpCache::ending)
            files.push_back(std::move(file));
    }
    return files;
}

/// The next line of `text`, which loses it.
std::string_view take_line(std::string_view& text) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

}  // namespace

std::shared_ptr<HttpCache> HttpCache::of_environment() {
    const char *folder = std::getenv("CHIARO_HTTP_CACHE"), *size = std::getenv("CHIARO_HTTP_CACHE_SIZE");
    if (!folder || !*folder) return nullptr;
    constexpr std::uint64_t least = 1 << 20;
    const auto bytes = bytes_from(size && *size ? size : "4G");
    if (!bytes || *bytes < least)
        throw Error(
            ErrorCode::usage,
            fmt::format("CHIARO_HTTP_CACHE_SIZE {}: must be a size such as 4G or 512M, 1M at least", one_line(size)));
    std::error_code error;
    const bool is_new = !std::filesystem::exists(folder, error);
    std::filesystem::create_directories(folder, error);
    if (is_new && !error) std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
    if (error || !std::filesystem::is_directory(folder, error))
        throw Error(ErrorCode::output,
                    fmt::format("CHIARO_HTTP_CACHE: '{}' is no folder, and cannot be made one", one_line(folder)));
    return std::make_shared<HttpCache>(folder, *bytes);
}

HttpCache::HttpCache(std::filesystem::path folder, std::uint64_t max_bytes)
    : folder_(std::move(folder)), max_bytes_(max_bytes) {}

std::filesystem::path HttpCache::file_of(const std::string& what) const {
    return folder_ / fmt::format("{:016x}{}", std::hash<std::string>{}(what), ending);
}

std::optional<HttpCache::Part> HttpCache::find(const std::string& what) const {
    const std::filesystem::path path = file_of(what);
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return {};
    try {
        const std::string all = file_text(path, max_bytes_);
        std::uint32_t sum = 0;
        if (all.size() < sizeof sum) return {};
        std::string_view rest(all.data(), all.size() - sizeof sum);
        std::memcpy(&sum, all.data() + rest.size(), sizeof sum);
        if (crc32c(std::as_bytes(std::span(rest))) != sum) return {};
        if (take_line(rest) != first_line || take_line(rest) != what) return {};
        Part part{std::string(take_line(rest)), 0, {}};
        const std::string_view size = take_line(rest);
        if (std::from_chars(size.data(), size.data() + size.size(), part.file_bytes).ec != std::errc()) return {};
        part.bytes = rest;
        return part;
    } catch (const std::exception&) {
        return {};
    }
}

void HttpCache::was_used(const std::string& what) const noexcept {
    std::error_code gone;
    std::filesystem::last_write_time(file_of(what), std::filesystem::file_time_type::clock::now(), gone);
}

void HttpCache::keep(const std::string& what, const Part& part) noexcept {
    try {
        std::string all = fmt::format("{}\n{}\n{}\n{}\n", first_line, what, part.tag, part.file_bytes) + part.bytes;
        const std::uint32_t sum = crc32c(std::as_bytes(std::span(all)));
        all.append(reinterpret_cast<const char*>(&sum), sizeof sum);
        if (all.size() > max_part_bytes()) return;
        {
            const std::lock_guard lock(mutex_);
            if (all.size() > room_) make_room();
            room_ -= all.size();
        }
        AtomicFile file(file_of(what), 0600);
        file.write(std::as_bytes(std::span(all)));
        file.commit_unflushed();
    } catch (const std::exception&) {
        return;  // what is fetched is of use all the same
    }
}

/// For a sixteenth of all, whatever else is there: two processes that share the folder keep to its size.
void HttpCache::make_room() {
    std::vector<KeptFile> files = kept_files(folder_);
    std::ranges::sort(files, {}, &KeptFile::used);
    std::uint64_t bytes = 0;
    for (const KeptFile& file : files) bytes += file.bytes;
    for (const KeptFile& file : files) {
        if (bytes <= max_bytes_ / 8 * 7) break;
        std::error_code gone;
        std::filesystem::remove(file.path, gone);
        bytes -= file.bytes;
    }
    room_ = max_part_bytes();
}

}  // namespace chiaro
