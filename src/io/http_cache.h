// What servers sent, kept in a folder.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace chiaro {

/// Each part of a file is a file here, written whole or not at all, with a checksum, and named after what it is of. The
/// server says each time whether it still holds (its ETag), so what is kept saves bytes and not questions. Several
/// processes may share a folder. What cannot be read is not there; where nothing can be written nothing is kept.
class HttpCache {
public:
    /// That of CHIARO_HTTP_CACHE (a folder, made where it is not there) and CHIARO_HTTP_CACHE_SIZE (4G); null where the
    /// former is not set. Throws Error{output} for a folder that cannot be had, Error{usage} for what is no size.
    static std::shared_ptr<HttpCache> of_environment();
    HttpCache(std::filesystem::path folder, std::uint64_t max_bytes);

    struct Part {
        std::string tag;               ///< what the server calls this state of the file
        std::uint64_t file_bytes = 0;  ///< of the whole file
        std::string bytes;
    };
    /// What is kept of it. `what`: address and part, in one line.
    std::optional<Part> find(const std::string& what) const;
    /// It is of use: others go before it.
    void was_used(const std::string& what) const noexcept;
    /// Keeps it in place of what was kept. What was used least recently goes where there is no room.
    void keep(const std::string& what, const Part& part) noexcept;
    std::uint64_t max_part_bytes() const { return max_bytes_ / 16; }  ///< what is larger is not kept

    static constexpr const char* ending = ".chiaro-http";

private:
    std::filesystem::path file_of(const std::string& what) const;
    void make_room();

    const std::filesystem::path folder_;
    const std::uint64_t max_bytes_;
    std::mutex mutex_;
    std::uint64_t room_ = 0;  ///< bytes that may be written before somebody looks what is there
};

}  // namespace chiaro
