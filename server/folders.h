// What of the machine's files a page may see.
#pragma once
#include <chiaro/scene.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "json.h"

namespace chiaro::server {

class Folders {
public:
    /// `hidden` ones may be read, but are not shown.
    Folders(const std::vector<std::filesystem::path>& roots, const std::vector<std::filesystem::path>& hidden);

    /// The path, absolute and without links, if it lies below a folder; relative paths begin at the first of them.
    /// Throws Error{input} otherwise.
    std::filesystem::path allowed(const std::string& path) const;
    /// The same for a volume's name, which may be a sample or go on inside a file ("file.h5:/path").
    std::string allowed_volume(const std::string& name) const;
    /// Throws Error{input} where the scene names a file elsewhere, its volume apart. The cache folder is the program's
    /// own affair.
    void confine(Scene& scene) const;
    /// What lies in a folder; of "" the folders themselves.
    Json list(const std::string& path) const;
    const std::filesystem::path& first() const { return roots_.front(); }

private:
    std::vector<std::filesystem::path> roots_;
    std::vector<std::filesystem::path> hidden_;
};

}  // namespace chiaro::server
