// A page without a browser: HTTP and WebSocket (RFC 6455) over a plain socket, as server/PROTOCOL.md speaks.
#pragma once
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

namespace chiaro::testing {

using Json = nlohmann::json;

/// A connection to the loopback that gives up after a time.
class Wire {
public:
    explicit Wire(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(std::uint16_t(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const int one = 1;
        setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
        if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
            throw std::runtime_error("no connection");
    }
    ~Wire() {
        if (fd_ >= 0) ::close(fd_);
    }
    Wire(Wire&& other) noexcept : fd_(std::exchange(other.fd_, -1)), read_(std::move(other.read_)) {}
    Wire(const Wire&) = delete;

    void write(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent <= 0) throw std::runtime_error("connection lost while writing");
            bytes.remove_prefix(std::size_t(sent));
        }
    }
    /// Exactly so many bytes; nothing where the connection ends or the time is over before.
    std::optional<std::string> read(std::size_t count, double seconds) {
        while (read_.size() < count)
            if (!more(seconds)) return {};
        std::string bytes = read_.substr(0, count);
        read_.erase(0, count);
        return bytes;
    }
    std::optional<std::string> read_until(std::string_view end, double seconds) {
        std::size_t at;
        while ((at = read_.find(end)) == read_.npos)
            if (!more(seconds)) return {};
        return read(at + end.size(), seconds);
    }
    std::string read_all(double seconds) {
        while (more(seconds)) {
        }
        return std::exchange(read_, "");
    }
    bool has_bytes() const { return !read_.empty(); }
    bool is_over() const { return over_; }

private:
    bool more(double seconds) {
        pollfd waiting{fd_, POLLIN, 0};
        if (over_ || poll(&waiting, 1, int(1000 * seconds)) <= 0) return false;
        char buffer[65536];
        const ssize_t count = recv(fd_, buffer, sizeof buffer, 0);
        if (count <= 0)
            over_ = true;
        else
            read_.append(buffer, std::size_t(count));
        return count > 0;
    }

    int fd_;
    std::string read_;
    bool over_ = false;
};

struct Answer {
    int status = 0;
    std::string head, body;
};

/// What a page may draw over a picture that it saves: two pixels, red, and red of which 128/255 covers.
inline constexpr const char* red_half_clear_png =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAD0lEQVR4nGP4"
    "z8DwH4gbABF4A35MCyl3AAAAAElFTkSuQmCC";

/// One request by HTTP. `host` replaces the right one where given.
inline Answer http(int port, const std::string& method, const std::string& target, const std::string& fields = "",
                   const std::string& body = "", const std::string& host = "") {
    Wire wire(port);
    const std::string name = host.empty() ? "localhost:" + std::to_string(port) : host;
    const std::string length = body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n";
    const std::string close = fields.find("Connection:") == fields.npos ? "Connection: close\r\n" : "";
    wire.write(method + " " + target + " HTTP/1.1\r\nHost: " + name + "\r\n" + close + fields + length + "\r\n" + body);
    const std::string all = wire.read_all(20);
    const std::size_t end = all.find("\r\n\r\n");
    if (all.size() < 12 || end == all.npos) return {};
    return {std::stoi(all.substr(9, 3)), all.substr(0, end), all.substr(end + 4)};
}

struct Message {
    bool is_frame = false;
    Json json;          ///< the message, or the frame's header
    std::string image;  ///< of a frame
};

/// A page's socket.
class Page {
public:
    /// Throws where the upgrade is refused.
    Page(int port, const std::string& token, const std::string& view, const std::string& rest = "",
         const std::string& fields = "")
        : wire_(port) {
        wire_.write("GET /socket?token=" + token + "&view=" + view + rest +
                    " HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
                    "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
                    "dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                    fields + "\r\n");
        const auto head = wire_.read_until("\r\n\r\n", 20);
        if (!head || head->substr(9, 3) != "101") throw std::runtime_error("refused: " + head.value_or(""));
        // RFC 6455, 1.3: what this key must be answered with.
        if (head->find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") == head->npos) throw std::runtime_error("wrong handshake");
    }

    void send(const Json& json) { send_raw(1, json.dump()); }
    void send_raw(int opcode, std::string_view payload, bool masked = true) {
        std::string frame(1, char(0x80 | opcode));
        const char bit = char(masked ? 0x80 : 0);
        if (payload.size() < 126)
            frame += char(bit | char(payload.size()));
        else if (payload.size() < 65536)
            frame += {char(bit | 126), char(payload.size() >> 8), char(payload.size())};
        else {
            frame += char(bit | 127);
            for (int shift = 56; shift >= 0; shift -= 8) frame += char(std::uint64_t(payload.size()) >> shift);
        }
        const char mask[4] = {17, 34, 51, 68};
        if (masked) frame.append(mask, 4);
        for (std::size_t i = 0; i < payload.size(); ++i) frame += char(payload[i] ^ (masked ? mask[i % 4] : 0));
        wire_.write(frame);
    }
    void write(std::string_view bytes) { wire_.write(bytes); }

    /// The next message; nothing where none comes in time, or the socket was closed (`closed()`).
    std::optional<Message> next(double seconds = 20) {
        for (;;) {
            const auto head = wire_.read(2, seconds);
            if (!head) return {};
            const int opcode = (*head)[0] & 15;
            std::uint64_t length = std::uint8_t((*head)[1]) & 127;
            if (length > 125) {
                const auto more = wire_.read(length == 126 ? 2 : 8, seconds);
                if (!more) return {};
                length = 0;
                for (const char c : *more) length = length << 8 | std::uint8_t(c);
            }
            const auto payload = wire_.read(length, seconds);
            if (!payload) return {};
            if (opcode == 8) {
                closed_ = payload->size() < 2 ? 1005 : std::uint8_t((*payload)[0]) << 8 | std::uint8_t((*payload)[1]);
                return {};
            }
            if (opcode == 9) send_raw(10, *payload);
            if (opcode == 1) return Message{false, Json::parse(*payload), ""};
            if (opcode == 2) return frame(*payload);
        }
    }

    /// The next for which `wanted` holds; others are passed over.
    template <class Wanted>
    std::optional<Message> find(Wanted&& wanted, double seconds = 30) {
        const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < until) {
            auto message = next(seconds);
            if (!message || wanted(*message)) return message;
        }
        return {};
    }
    /// The answer (or error) to a request.
    Json ask(Json request, double seconds = 60) {
        request["id"] = ++last_id_;
        send(request);
        const auto answer = find(
            [&](const Message& m) {
                return !m.is_frame && (m.json["type"] == "answer" || m.json["type"] == "error") &&
                       m.json["re"] == last_id_;
            },
            seconds);
        return answer ? answer->json : Json();
    }
    std::optional<Message> of_type(const std::string& type, double seconds = 30) {
        return find([&](const Message& m) { return !m.is_frame && m.json["type"] == type; }, seconds);
    }
    std::optional<Message> of_stage(std::int64_t n, const std::string& stage, double seconds = 60) {
        return find([&](const Message& m) { return m.is_frame && m.json["n"] == n && m.json["stage"] == stage; },
                    seconds);
    }
    /// The close code, once the socket was closed; reads what comes before.
    int closed(double seconds = 10) {
        while (!closed_ && next(seconds)) {
        }
        return closed_;
    }
    bool is_over() const { return wire_.is_over(); }

private:
    static Message frame(const std::string& bytes) {
        if (bytes.size() < 8 || bytes.substr(0, 4) != "CHF1") throw std::runtime_error("no frame");
        std::uint32_t length = 0;
        for (int i = 7; i >= 4; --i) length = length << 8 | std::uint8_t(bytes[std::size_t(i)]);
        return {true, Json::parse(bytes.substr(8, length)), bytes.substr(8 + length)};
    }

    Wire wire_;
    int closed_ = 0;
    std::int64_t last_id_ = 1000;
};

}  // namespace chiaro::testing
