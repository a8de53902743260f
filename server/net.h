// HTTP and WebSocket, and nothing of what is said over them. Boost.Beast lives behind this in net.cpp alone.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chiaro::server {

struct Request {
    std::string method, path;
    std::map<std::string, std::string> query;
    std::string body;
    std::uint64_t bytes = 0;  ///< of a body that went to a file
};

struct Response {
    int status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::string body;
    std::filesystem::path file;  ///< sent instead of the body where given, and deleted
    std::string save_as;         ///< what a browser calls it
};

/// One page's connection. Every call may come from any thread and returns at once; a connection that is gone swallows
/// what it is sent.
class Socket {
public:
    virtual ~Socket() = default;
    virtual void send(std::string text) = 0;
    virtual void send_binary(std::string bytes) = 0;
    /// A binary message that replaces one sent so that still waits: a slow reader gets fewer, never old ones.
    virtual void send_newest(std::string bytes) = 0;
    virtual void close(int code, std::string reason) = 0;
};

/// What a page says. Called by the network's thread, which does nothing else meanwhile: what takes time is done
/// elsewhere.
class Listener {
public:
    virtual ~Listener() = default;
    /// `done` may be called by any thread, once; the page's next message is read then.
    virtual void hear(const Socket& from, std::string text, std::function<void()> done) = 0;
    virtual void gone(const Socket& from) = 0;
};

/// What is served. Called by the network's thread, as a Listener is.
class Site {
public:
    virtual ~Site() = default;
    /// The answer, or nothing where `later` brings it; that may be called by any thread, once.
    virtual std::optional<Response> answer(Request request, std::function<void(Response)> later) = 0;
    /// Whether who asks has been let in: has the token, or the key of a download.
    virtual bool is_known(const Request& request) const = 0;
    /// Of an admitted POST whose body goes to a file as it comes: that file, which must not be there yet; else "".
    /// `request.bytes` is what will come. Throws Error whose sentence is told.
    virtual std::filesystem::path destination(const Request& request) = 0;
    /// That body did not come whole; the file is gone.
    virtual void abandon(const Request& request) = 0;
    /// Whether a WebSocket may be opened: status 200 if so.
    virtual Response admit(const Request& request) = 0;
    virtual std::shared_ptr<Listener> welcome(const Request& request, std::shared_ptr<Socket> socket) = 0;
    virtual void tick() = 0;  ///< every few seconds
    virtual void end() = 0;   ///< once, before the sockets are closed
};

struct Address {
    std::string host = "127.0.0.1";
    int port = 0;             ///< 0: any that is free
    bool or_another = false;  ///< takes a free port where this one is taken
    std::vector<std::string>
        embed_from{};  ///< origins that may frame the page and ask through a proxy, "https://hub.org"
};

/// Listens from its construction on; throws Error{usage} for an address that is none, Error{output} where it cannot be
/// had.
class Net {
public:
    Net(const Address& address, Site& site);
    ~Net();
    int port() const;
    /// Serves until `stop`, or SIGINT or SIGTERM where `signals`; then tells the site and closes every socket.
    void run(bool signals);
    void stop();  ///< from any thread
    /// Calls it in the network's thread, unless that has ended before.
    void post(std::function<void()> work);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace chiaro::server
