// The page's files, which are part of the program.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace chiaro::server {

struct PageFile {
    std::string_view type, bytes;
};

/// By its path below the page's folder ("index.html").
std::optional<PageFile> page_file(std::string_view name);

}  // namespace chiaro::server
