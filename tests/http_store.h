// A small store on a server of the test's own, and why it cannot be read.
#pragma once
#include <chiaro/error.h>
#include <sys/wait.h>

#include "http_server.h"
#include "zarr_files.h"

namespace volume_files {

inline const chiaro::ReadOptions named{.private_addresses = true};
inline constexpr std::size_t store_voxels = 64 * 64 * 64;

inline ZarrLayout layout(bool has_shards) {
    return {.shape = {64, 64, 64},
            .chunk = {16, 32, 16},
            .version = 3,
            .codec = "gzip",
            .separator = '/',
            .shard = has_shards ? Sizes{32, 64, 32} : Sizes{}};
}

inline std::map<std::string, std::string> store(const ZarrLayout& layout, const std::string& folder = "/a.zarr/") {
    std::map<std::string, std::string> files;
    for (const auto& [name, bytes] : zarr_files(layout, ramp<std::uint16_t>(store_voxels)))
        files[folder + name] = bytes;
    return files;
}

inline chiaro::Volume read_from(const std::string& url, const chiaro::ReadOptions& options = named) {
    chiaro::Progress progress;
    return chiaro::read_volume(url, options, progress);
}

/// Why a store cannot be read whose answers are changed so.
inline std::string refusal(bool has_shards, const std::function<void(const HttpRequest&, HttpAnswer&)>& change,
                           const chiaro::ReadOptions& options = named) {
    const HttpServer server([&, whole = handler_of(store(layout(has_shards)))](const HttpRequest& request) {
        HttpAnswer answer = whole(request);
        change(request, answer);
        return answer;
    });
    try {
        read_from(server.url("a.zarr"), options);
    } catch (const chiaro::Error& error) {
        const std::string sentence = error.what();
        EXPECT_EQ(error.code(), chiaro::ErrorCode::input) << sentence;
        EXPECT_EQ(sentence.find('\n'), sentence.npos) << sentence;
        EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a zombie after: " << sentence;
        return sentence;
    }
    return "nothing was wrong";
}

inline bool is_chunk(const HttpRequest& request) { return request.path.find("/c/") != request.path.npos; }

inline void expect_in(const std::string& part, const std::string& sentence) {
    EXPECT_NE(sentence.find(part), sentence.npos) << sentence;
}

inline std::string without(std::vector<std::string>& headers, const std::string& name) {
    std::string found;
    std::erase_if(headers, [&](const std::string& h) { return h.starts_with(name) && (found = h, true); });
    return found;
}

}  // namespace volume_files
