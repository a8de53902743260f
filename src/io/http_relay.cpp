#include "io/http_relay.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>

namespace chiaro {

class HttpRelay::End {
public:
    explicit End(Descriptor connection) : connection_(std::move(connection)) {}

    void hang_up() const { shutdown(connection_.number(), SHUT_RDWR); }

    bool send(std::string_view bytes) const {
        while (!bytes.empty()) {
            const ssize_t n = ::send(connection_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return false;
            bytes.remove_prefix(std::size_t(n));
        }
        return true;
    }
    /// Without its end; none where the other end is gone, or says no end of a line.
    std::optional<std::string> line() {
        constexpr std::size_t longest = 1 << 14;
        for (;;) {
            if (const auto end = received_.find('\n'); end != received_.npos) {
                std::string line = received_.substr(0, end);
                received_.erase(0, end + 1);
                return line;
            }
            if (received_.size() > longest || !receive()) return {};
        }
    }
    /// At most so many bytes, as they come; empty where the other end is gone.
    std::string some(std::uint64_t most) {
        if (received_.empty() && !receive()) return {};
        std::string bytes = received_.substr(0, std::size_t(std::min<std::uint64_t>(most, received_.size())));
        received_.erase(0, bytes.size());
        return bytes;
    }

private:
    bool receive() {
        char piece[1 << 16];
        ssize_t n = 0;
        while ((n = recv(connection_.number(), piece, sizeof piece, 0)) < 0 && errno == EINTR) continue;
        if (n > 0) received_.append(piece, std::size_t(n));
        return n > 0;
    }

    Descriptor connection_;
    std::string received_;
};

HttpRelay::HttpRelay(std::shared_ptr<HttpCache> cache, std::string url, Descriptor decoder, Descriptor fetcher)
    : cache_(std::move(cache)),
      url_(std::move(url)),
      decoder_(std::make_unique<End>(std::move(decoder))),
      fetcher_(std::make_unique<End>(std::move(fetcher))),
      thread_([this] { run(); }) {}

HttpRelay::~HttpRelay() {
    decoder_->hang_up(), fetcher_->hang_up();
    thread_.join();
}

void HttpRelay::run() {
    try {
        for (auto request = decoder_->line(); request && answer(*request); request = decoder_->line()) continue;
    } catch (const std::bad_alloc&) {  // as if it were gone
    }
    decoder_->hang_up(), fetcher_->hang_up();
    has_ended_ = true;
}

/// False where somebody is gone, or makes no sense.
bool HttpRelay::answer(const std::string& request) {
    const std::string what = url_ + " " + request;
    const auto kept = cache_->find(what);
    if (!fetcher_->send(fmt::format("unless {} {}\n", kept ? kept->tag : "-", request))) return false;
    for (;;) {
        const auto said = fetcher_->line();
        if (!said) return false;
        if (said->starts_with("part ")) return forward(what, *said);
        if (*said == "same") {
            if (!kept) return false;
            cache_->was_used(what);
            return decoder_->send(fmt::format("part {} {}\n", kept->bytes.size(), kept->file_bytes)) &&
                   decoder_->send(kept->bytes);
        }
        if (!decoder_->send(*said + "\n")) return false;
        if (*said != "wait") return true;
    }
}

/// "part BYTES SIZE TAG", and the bytes as they come.
bool HttpRelay::forward(const std::string& what, std::string_view part) {
    const auto tag_at = part.rfind(' ');
    const std::string_view plain = part.substr(0, tag_at);
    HttpCache::Part kept{std::string(part.substr(tag_at + 1)), 0, {}};
    std::uint64_t bytes = 0;
    const char *at = plain.data() + std::string_view("part ").size(), *const end = plain.data() + plain.size();
    const auto first = std::from_chars(std::min(at, end), end, bytes);
    if (first.ec != std::errc() || first.ptr == end) return false;
    if (std::from_chars(first.ptr + 1, end, kept.file_bytes).ec != std::errc()) return false;
    if (!decoder_->send(std::string(plain) + "\n")) return false;
    const bool is_kept = kept.tag != "-" && bytes <= cache_->max_part_bytes();
    for (std::uint64_t left = bytes; left > 0;) {
        const std::string some = fetcher_->some(left);
        if (some.empty() || !decoder_->send(some)) return false;
        if (is_kept) kept.bytes += some;
        left -= some.size();
    }
    if (is_kept) cache_->keep(what, kept);
    return true;
}

}  // namespace chiaro
