// What views looked like, on disk: for a server that was killed, and for a page that was closed by mistake.
#pragma once
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "json.h"

namespace chiaro::server {

struct KeptView {
    std::string view, volume;  ///< its id; what was open, by name
    Json scene, undo;          ///< undo is the page's own affair
    double seconds = 0;        ///< how long ago
};

/// One file a view, mode 0600, written whole or not at all, at most half a second after a change; gone after 30 days,
/// and the oldest of more than 200.
class KeptViews {
public:
    /// "": nothing is kept.
    explicit KeptViews(std::filesystem::path folder);
    ~KeptViews();  ///< writes what waits
    KeptViews(const KeptViews&) = delete;
    KeptViews& operator=(const KeptViews&) = delete;

    void note(const KeptView& kept);
    std::optional<KeptView> find(const std::string& view) const;
    /// The newest of this volume, of another view than `except`.
    std::optional<KeptView> newest_of(const std::string& volume, const std::string& except) const;
    /// The volumes that are named.
    std::vector<std::filesystem::path> volumes() const;
    /// Forgets those whose volumes lie below a folder that goes, for good.
    void forget_below(const std::filesystem::path& folder);

private:
    std::filesystem::path file_of(const std::string& view) const;
    std::vector<KeptView> on_disk() const;
    std::map<std::string, KeptView> all() const;  ///< by view; those that are not there yet, too
    void run();
    void write(const KeptView& kept) const;
    bool is_gone(const KeptView& kept) const;  ///< while locked

    std::filesystem::path folder_;
    mutable std::mutex mutex_;
    std::mutex writing_;                       ///< held while files change; taken before `mutex_`
    std::vector<std::filesystem::path> gone_;  ///< what was forgotten
    std::condition_variable changed_;
    std::map<std::string, KeptView> waiting_, being_written_;  ///< by view; neither is on disk yet
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace chiaro::server
