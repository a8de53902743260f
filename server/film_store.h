// Frames of films that are being written, on disk: what broke off goes on where it was, in a later server too.
#pragma once
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

namespace chiaro::server {

/// A folder (0700) a film, with a PNG (0600) a frame, each there whole or not at all. A film's folder goes when the
/// film is done, was given up or the server ends; what a killed server left goes a day later, at a start.
class FilmStore {
public:
    /// `root`: below which the folders lie.
    explicit FilmStore(std::filesystem::path root);
    ~FilmStore();
    FilmStore(const FilmStore&) = delete;
    FilmStore& operator=(const FilmStore&) = delete;

    /// The folder for the frames that a text describes completely: another text has another. Throws Error{output}.
    std::filesystem::path folder_of(const std::string& text);
    void remove(const std::filesystem::path& folder);
    void clear();  ///< removes all that it made

private:
    const std::filesystem::path root_;
    std::mutex mutex_;
    std::set<std::filesystem::path> made_;
};

}  // namespace chiaro::server
