// Volumes that pages send: streamed to a private folder, one below it for each.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace chiaro::server {

inline constexpr std::size_t max_upload_files = 20000;

class Uploads {
public:
    /// In a new folder of the user's cache, or of the temporary files where there is none. It goes with the program;
    /// those that killed programs left behind go now, but for folders that hold something of `kept`,
    /// which are its own from now on.
    Uploads(std::uint64_t max_bytes, const std::vector<std::filesystem::path>& kept);
    ~Uploads();
    Uploads(const Uploads&) = delete;
    Uploads& operator=(const Uploads&) = delete;

    /// Its own, and those that were kept.
    std::vector<std::filesystem::path> folders() const;
    /// Whether a volume of so many bytes in so many files may come: before the first of it does. Throws as `begin`.
    void check_room(std::uint64_t bytes, std::uint64_t files) const;
    /// Where so many bytes of a volume's file go. A name's folders become part of it: files lie side by side, as
    /// readers of folders want them. Throws Error{usage} beyond the limits, Error{output} where the disk has no room.
    std::filesystem::path begin(const std::string& volume, const std::string& name, std::uint64_t bytes);
    /// That file did not come whole.
    void abandon(const std::string& volume, std::uint64_t bytes);
    /// What to open: the one file, the one header among several, or their folder. Throws Error{usage} for none.
    std::string to_open(const std::string& volume) const;
    /// Takes what came of a volume away.
    void discard(const std::string& volume);
    /// Takes all away, at once.
    void remove();

private:
    [[noreturn]] void refuse_size() const;
    [[noreturn]] void refuse_count() const;
    void check_disk(std::uint64_t bytes) const;
    struct Sent {
        std::filesystem::path folder;
        std::uint64_t bytes = 0;
        std::size_t files = 0;
    };

    std::filesystem::path folder_;
    std::vector<std::pair<std::filesystem::path, int>> owned_;  ///< and their locks
    std::uint64_t max_bytes_;
    mutable std::mutex mutex_;
    std::map<std::string, Sent> sent_;
};

}  // namespace chiaro::server
