// A file that is written whole or not at all.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace chiaro {

/// Collects bytes in a file without a name in the folder of `path` (where the file system has none, in one beside
/// `path`), which takes the name on commit, so that neither a full disk nor an interruption leaves half a file. Even
/// being killed leaves nothing, but where another file had that name, for the instant between a temporary name and the
/// rename. Every member throws Error{output}, naming the path and the reason.
class AtomicFile {
public:
    /// `mode` is what umask takes from.
    explicit AtomicFile(std::filesystem::path path, unsigned mode = 0666);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    ~AtomicFile();  ///< removes the temporary unless committed

    void write(std::span<const std::byte> bytes);
    /// The same for much that is not read soon, from an address at a page's beginning: past the system's cache, where
    /// the file system knows how and nothing was written before.
    void write_past_cache(std::span<const std::byte> bytes);
    void flush();   ///< to the disk, before `commit` does
    void commit();  ///< flushed to the disk before it takes the name
    /// Takes the name at once: after a power failure it may hold anything.
    void commit_unflushed();

private:
    /// Looks for a free temporary name; `take` makes the file and leaves errno where it cannot.
    void take_name(const std::function<bool()>& take);
    [[noreturn]] void fail(int error_number) const;

    std::filesystem::path path_, temporary_;
    int descriptor_ = -1;
    bool is_flushed_ = false;
};

}  // namespace chiaro
