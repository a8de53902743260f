// A file that is written whole or not at all.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>

namespace chiaro {

/// Collects bytes in a temporary file beside `path` and renames it over `path` on commit, so that neither a full disk
/// nor an interruption leaves half a file. Every member throws Error{output}, naming the path and the reason.
class AtomicFile {
public:
    explicit AtomicFile(std::filesystem::path path);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    ~AtomicFile();  ///< removes the temporary unless committed

    void write(std::span<const std::byte> bytes);
    void commit();  ///< flushed to the disk before it takes the name

private:
    [[noreturn]] void fail(int error_number) const;

    std::filesystem::path path_, temporary_;
    int descriptor_ = -1;
};

}  // namespace chiaro
