// A small server of files that are made when they are asked for, whole, wrong or late.
#pragma once
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace volume_files {

struct HttpRequest {
    std::string path;
    std::map<std::string, std::string> headers;  ///< by their names in small letters
};

struct HttpAnswer {
    int status = 200;
    std::string body;
    std::vector<std::string> headers;
    std::optional<std::size_t> cut_at;  ///< the connection ends there, half-way
    int late_ms = 0;
    bool is_silent = false;  ///< nothing is ever said
};

/// The way to a server: all its answers share it.
struct HttpLink {
    int round_trip_ms = 0;
    double bytes_per_second = 0;  ///< 0: as many as there are
};

class HttpServer {
public:
    using Handler = std::function<HttpAnswer(const HttpRequest&)>;
    explicit HttpServer(Handler handler, HttpLink link = {})
        : handler_(std::move(handler)), link_(link), listening_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET, address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        if (bind(listening_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(listening_, 64) != 0 ||
            getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
            throw std::runtime_error("no server");
        port_ = ntohs(address.sin_port);
        accepting_ = std::thread([this] { accept_all(); });
    }
    HttpServer(const HttpServer&) = delete;
    HttpServer& operator=(const HttpServer&) = delete;
    ~HttpServer() {
        is_over_ = true;
        shutdown(listening_, SHUT_RDWR);
        accepting_.join();
        {
            const std::lock_guard lock(mutex_);
            for (const int connection : connections_) shutdown(connection, SHUT_RDWR);
        }
        for (auto& thread : threads_) thread.join();
        for (const int connection : connections_) close(connection);
        close(listening_);
    }

    int port() const { return port_; }
    std::string url(const std::string& path) const { return fmt::format("http://127.0.0.1:{}/{}", port_, path); }
    std::uint64_t bytes() const { return bytes_; }  ///< of bodies that were sent
    int most_at_once() const { return most_; }      ///< requests
    std::vector<HttpRequest> requests() const {
        const std::lock_guard lock(mutex_);
        return requests_;
    }

private:
    void accept_all() {
        for (;;) {
            const int connection = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
            if (connection < 0) return;
            const std::lock_guard lock(mutex_);
            connections_.push_back(connection);
            threads_.emplace_back([this, connection] { serve(connection); });
        }
    }

    void serve(int connection) {
        std::string received;
        for (;;) {
            std::size_t end = 0;
            while ((end = received.find("\r\n\r\n")) == received.npos) {
                char piece[4096];
                const ssize_t n = recv(connection, piece, sizeof piece, 0);
                if (n <= 0) return;
                received.append(piece, std::size_t(n));
            }
            const HttpRequest request = parsed(received.substr(0, end + 2));
            received.erase(0, end + 4);
            const int now = ++at_once_;
            for (int most = most_; now > most && !most_.compare_exchange_weak(most, now);) continue;
            {
                const std::lock_guard lock(mutex_);
                requests_.push_back(request);
            }
            const bool goes_on = answer(connection, handler_(request));
            --at_once_;
            if (!goes_on) return;
        }
    }

    bool answer(int connection, const HttpAnswer& answer) {
        if (answer.is_silent) {
            char none = 0;
            return recv(connection, &none, 1, 0) < 0;  // until the other end gives up
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(answer.late_ms + link_.round_trip_ms));
        std::string all = fmt::format("HTTP/1.1 {} Said\r\nContent-Length: {}\r\n", answer.status, answer.body.size());
        for (const auto& header : answer.headers) all += header + "\r\n";
        all += "\r\n" + answer.body.substr(0, answer.cut_at.value_or(answer.body.size()));
        for (std::size_t sent = 0; sent < all.size();) {
            const std::size_t part =
                link_.bytes_per_second > 0 ? std::min<std::size_t>(all.size() - sent, 16384) : all.size() - sent;
            wait_for_link(part);
            const ssize_t n = send(connection, all.data() + sent, part, MSG_NOSIGNAL);
            if (n <= 0) return false;
            sent += std::size_t(n);
        }
        bytes_ += answer.body.size();
        if (answer.cut_at) shutdown(connection, SHUT_RDWR);
        return !answer.cut_at;
    }

    /// Until so many bytes are through.
    void wait_for_link(std::size_t bytes) {
        if (link_.bytes_per_second <= 0) return;
        std::chrono::steady_clock::time_point through;
        {
            const std::lock_guard lock(mutex_);
            const std::chrono::duration<double> takes(double(bytes) / link_.bytes_per_second);
            link_free_ = std::max(link_free_, std::chrono::steady_clock::now()) +
                         std::chrono::duration_cast<std::chrono::steady_clock::duration>(takes);
            through = link_free_;
        }
        std::this_thread::sleep_until(through);
    }

    static HttpRequest parsed(const std::string& head) {
        HttpRequest request;
        const auto first = head.find(' '), second = head.find(' ', first + 1);
        request.path = head.substr(first + 1, second - first - 1);
        for (std::size_t at = head.find("\r\n") + 2; at < head.size();) {
            const auto end = head.find("\r\n", at), colon = head.find(": ", at);
            std::string name = head.substr(at, colon - at);
            std::ranges::transform(name, name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
            request.headers[name] = head.substr(colon + 2, end - colon - 2);
            at = end + 2;
        }
        return request;
    }

    Handler handler_;
    const HttpLink link_;
    std::chrono::steady_clock::time_point link_free_{};
    int listening_, port_ = 0;
    std::atomic<bool> is_over_{false};
    std::atomic<std::uint64_t> bytes_{0};
    std::atomic<int> at_once_{0}, most_{0};
    mutable std::mutex mutex_;
    std::vector<HttpRequest> requests_;
    std::vector<int> connections_;
    std::vector<std::thread> threads_;
    std::thread accepting_;
};

/// What a server says that knows ranges, and whether who asks has the file already.
inline HttpAnswer answer_with(const std::string& file, const HttpRequest& request, const std::string& tag = "\"one\"") {
    const auto unless = request.headers.find("if-none-match");
    if (unless != request.headers.end() && unless->second == tag) return {.status = 304, .headers = {"ETag: " + tag}};
    HttpAnswer answer{.body = file, .headers = {"ETag: " + tag}};
    const auto range = request.headers.find("range");
    if (range == request.headers.end()) return answer;
    const std::string text = range->second.substr(std::string("bytes=").size());
    const auto dash = text.find('-');
    std::size_t first = 0, last = file.size() - 1;
    if (dash == 0) {
        first = file.size() - std::min<std::size_t>(file.size(), std::stoul(text.substr(1)));
    } else {
        first = std::stoul(text.substr(0, dash));
        if (dash + 1 < text.size()) last = std::min<std::size_t>(last, std::stoul(text.substr(dash + 1)));
    }
    if (first >= file.size()) return {.status = 416};
    answer.status = 206;
    answer.body = file.substr(first, last - first + 1);
    answer.headers.push_back(fmt::format("Content-Range: bytes {}-{}/{}", first, last, file.size()));
    return answer;
}

/// Files by their paths; all others are not found.
inline HttpServer::Handler handler_of(std::map<std::string, std::string> files) {
    return [files = std::move(files)](const HttpRequest& request) -> HttpAnswer {
        const auto found = files.find(request.path);
        return found == files.end() ? HttpAnswer{.status = 404, .body = "none"} : answer_with(found->second, request);
    };
}

}  // namespace volume_files
