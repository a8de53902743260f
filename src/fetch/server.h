// The server that the command line named: what is fetched lies there, below one address.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace chiaro::fetch {

/// What of a file is asked for.
struct Part {
    enum class Kind { all, range, last };
    Kind kind = Kind::all;
    std::uint64_t first = 0, bytes = 0;  ///< of `all` and `last`: at most so many
};

struct Request {
    Part part;
    std::string path;  ///< below the server's address
    /// What stands for the contents that who asks has ("-": none), and may go on to use; none: wants no such word.
    std::optional<std::string> unless = {};
};

/// "all BYTES PATH", "range FIRST BYTES PATH" or "last BYTES PATH", or one of these behind "unless TAG "; none for
/// anything else.
std::optional<Request> request_from(const std::string& line);

struct Server {
    std::string url;                   ///< without '/' at its end
    bool may_be_private = false;       ///< its own host, not one that it leads to
    std::vector<std::string> headers;  ///< as they are sent to it, and to nobody else
    std::string certificates;          ///< a file; empty: the system's
    /// Answers to what every decoder asks at its start, by request: metadata, and that there are none.
    std::unordered_map<std::string, std::string> metadata{};
    /// What stood for the contents of files of which parts were read.
    mutable std::unordered_map<std::string, std::string> tags{};

    /// Of a file; all but letters, digits and -._~/ is written as %XX.
    std::string url_of(const std::string& path) const;
};

/// Whether a file says what others hold: few ask for much of it.
bool is_metadata(const std::string& path);

/// Whether an ETag stands for the bytes themselves, and is written as one is.
bool is_strong(const std::string& tag);

/// CHIARO_HTTP_TOKEN and CHIARO_HTTP_HEADERS (a header a line) of the environment.
std::vector<std::string> headers_from_environment();

/// "scheme://host:port" of an address.
std::string origin_of(const std::string& url);

}  // namespace chiaro::fetch
