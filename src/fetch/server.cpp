#include "fetch/server.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <sstream>

namespace chiaro::fetch {

std::optional<Request> request_from(const std::string& line) {
    Request request;
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto word_is = [&](std::string_view word) {
        const bool is_it = std::string_view(at, std::size_t(end - at)).starts_with(word);
        at += is_it ? word.size() : 0;
        return is_it;
    };
    const auto take = [&](std::uint64_t& number) {
        const auto [next, error] = std::from_chars(at, end, number);
        const bool is_there = error == std::errc() && next < end && *next == ' ';
        at = is_there ? next + 1 : end;
        return is_there;
    };
    if (word_is("unless ")) {
        const char* const tag_end = std::find(at, end, ' ');
        request.unless = std::string(at, tag_end);
        if (tag_end == end || (request.unless != "-" && !is_strong(*request.unless))) return {};
        at = tag_end + 1;
    }
    using enum Part::Kind;
    const char kind = at < end ? *at : ' ';
    if (!word_is("all ") && !word_is("last ") && !word_is("range ")) return {};
    request.part.kind = kind == 'a' ? all : kind == 'l' ? last : range;
    if (request.part.kind == range && !take(request.part.first)) return {};
    if (!take(request.part.bytes) || request.part.bytes == 0) return {};
    if (request.part.first + request.part.bytes < request.part.first) return {};
    request.path.assign(at, end);
    return request;
}

std::string Server::url_of(const std::string& path) const {
    constexpr char digits[] = "0123456789ABCDEF";
    std::string all = url + "/";
    for (const char c : path) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte < 128 && std::isalnum(byte)) || std::string_view("-._~/").find(c) != std::string_view::npos)
            all += c;
        else
            all += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    return all;
}

bool is_metadata(const std::string& path) {
    const std::string name = path.substr(path.rfind('/') + 1);
    return name == "zarr.json" || name == ".zarray" || name == ".zattrs" || name == ".zgroup";
}

bool is_strong(const std::string& tag) {
    constexpr std::size_t longest = 200;
    return tag.size() >= 2 && tag.size() <= longest && tag.front() == '"' && tag.back() == '"' &&
           std::ranges::all_of(tag, [](unsigned char c) { return c > 32 && c < 127; });
}

std::vector<std::string> headers_from_environment() {
    std::vector<std::string> headers;
    if (const char* token = std::getenv("CHIARO_HTTP_TOKEN"); token && *token)
        headers.push_back("Authorization: Bearer " + std::string(token));
    if (const char* more = std::getenv("CHIARO_HTTP_HEADERS")) {
        std::istringstream lines(more);
        for (std::string line; std::getline(lines, line);)
            if (line.find(':') != line.npos) headers.push_back(line);
    }
    for (std::string& header : headers) std::erase_if(header, [](char c) { return c == '\r' || c == '\n'; });
    return headers;
}

std::string origin_of(const std::string& url) {
    const auto host = url.find("://");
    if (host == url.npos) return url;
    return url.substr(0, url.find_first_of("/?#", host + 3));
}

}  // namespace chiaro::fetch
