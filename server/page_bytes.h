// What cmake/embed.cmake writes.
#pragma once
#include <span>
#include <string_view>

namespace chiaro::server {

struct EmbeddedFile {
    std::string_view name, bytes;
};
std::span<const EmbeddedFile> embedded_files();

}  // namespace chiaro::server
