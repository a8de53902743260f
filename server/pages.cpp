#include "pages.h"

#include "page_bytes.h"

namespace chiaro::server {
namespace {

std::string_view type_of(std::string_view name) {
    constexpr std::pair<std::string_view, std::string_view> types[] = {{".html", "text/html; charset=utf-8"},
                                                                       {".css", "text/css; charset=utf-8"},
                                                                       {".js", "text/javascript; charset=utf-8"},
                                                                       {".mjs", "text/javascript; charset=utf-8"},
                                                                       {".json", "application/json"},
                                                                       {".svg", "image/svg+xml"},
                                                                       {".webmanifest", "application/manifest+json"},
                                                                       {".png", "image/png"}};
    for (const auto& [ending, type] : types)
        if (name.ends_with(ending)) return type;
    return "application/octet-stream";
}

}  // namespace

std::optional<PageFile> page_file(std::string_view name) {
    for (const EmbeddedFile& file : embedded_files())
        if (file.name == name) return PageFile{type_of(name), file.bytes};
    return {};
}

}  // namespace chiaro::server
