// The only file that knows Boost.Beast: connections, their limits, and who may connect from where.
#include "net.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <utility>  // which Boost 1.74 forgets

#include <algorithm>
#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <chrono>
#include <deque>
#include <optional>
#include <set>

namespace chiaro::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr std::size_t largest_message = 1 << 20, largest_upload = 64 << 20, largest_backlog = 256 << 20;
constexpr std::size_t most_connections = 192, most_sockets = 128;
constexpr double burst = 400, messages_per_second = 200;

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string decoded(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escaped =
            text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
        if (!escaped) {
            out += text[i];
            continue;
        }
        out += char(16 * hex_digit(text[i + 1]) + hex_digit(text[i + 2]));
        i += 2;
    }
    return out;
}

Request request_of(std::string_view method, std::string_view target) {
    Request request;
    request.method = method;
    const std::size_t mark = std::min(target.find('?'), target.size());
    request.path = decoded(target.substr(0, mark));
    for (std::size_t begin = mark + 1; begin < target.size();) {
        const std::size_t end = std::min(target.find('&', begin), target.size());
        const std::string_view pair = target.substr(begin, end - begin);
        const std::size_t equals = std::min(pair.find('='), pair.size());
        request.query[decoded(pair.substr(0, equals))] = decoded(pair.substr(std::min(equals + 1, pair.size())));
        begin = end + 1;
    }
    return request;
}

/// The name in "name:port" or "[::1]:port".
std::string host_name(std::string_view host) {
    const std::size_t colon = host.rfind(':'), bracket = host.rfind(']');
    const bool has_port = colon != host.npos && (bracket == host.npos || bracket < colon);
    return std::string(has_port ? host.substr(0, colon) : host);
}

bool is_address(const std::string& name) {
    const bool bracketed = name.size() > 2 && name.front() == '[' && name.back() == ']';
    boost::system::error_code error;
    asio::ip::make_address(bracketed ? name.substr(1, name.size() - 2) : name, error);
    return !error;
}

/// Against pages of others that have a browser ask this server: the name that was asked for must be one of ours (DNS
/// rebinding), and a page that asks must come from here.
class Doorman {
public:
    explicit Doorman(const std::string& host) : names_{"localhost", "127.0.0.1", "[::1]"} {
        boost::system::error_code error;
        const auto address = asio::ip::make_address(host, error);
        is_everywhere_ = !error && address.is_unspecified();
        names_.insert(!error && address.is_v6() ? "[" + host + "]" : host);
        if (is_everywhere_) names_.insert(asio::ip::host_name());
    }

    bool lets_in(std::string_view host, std::string_view origin) const {
        const std::string name = host_name(host);
        const bool is_ours = names_.count(name) || (is_everywhere_ && is_address(name));
        return is_ours && (origin.empty() || origin == "http://" + std::string(host));
    }

private:
    std::set<std::string> names_;
    bool is_everywhere_;
};

/// So many at once, and so many a second.
class Allowance {
public:
    bool take() {
        const auto now = Clock::now();
        left_ = std::min(burst, left_ + messages_per_second * std::chrono::duration<double>(now - last_).count());
        last_ = now;
        if (left_ < 1) return false;
        left_ -= 1;
        return true;
    }

private:
    double left_ = burst;
    Clock::time_point last_ = Clock::now();
};

struct Context {
    Context(Site& served, const std::string& host) : site(served), doorman(host) {}

    Site& site;
    Doorman doorman;
    std::size_t connections = 0;
    std::set<std::shared_ptr<class WebSocket>> sockets;
    bool ending = false;
};

class WebSocket : public Socket, public std::enable_shared_from_this<WebSocket> {
public:
    WebSocket(tcp::socket socket, Context& context) : stream_(std::move(socket)), context_(context) {}

    void open(http::request<http::string_body> upgrade, Request request) {
        auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
        timeout.keep_alive_pings = true;
        stream_.set_option(timeout);
        stream_.read_message_max(largest_message);
        stream_.auto_fragment(false);
        stream_.async_accept(upgrade,
                             [self = shared_from_this(), request = std::move(request)](beast::error_code error) {
                                 if (error || self->context_.ending) return;
                                 self->context_.sockets.insert(self);
                                 self->is_open_ = true;
                                 self->listener_ = self->context_.site.welcome(request, self);
                                 self->listener_ ? self->read() : self->shut(websocket::close_code::policy_error, "");
                             });
    }

    void send(std::string text) override { post({std::move(text), false, false}); }
    void send_binary(std::string bytes) override { post({std::move(bytes), true, false}); }
    void send_newest(std::string bytes) override { post({std::move(bytes), true, true}); }
    void close(int code, std::string reason) override {
        asio::post(stream_.get_executor(), [self = shared_from_this(), code, reason = std::move(reason)] {
            self->shut(websocket::close_code(code), reason);
        });
    }

    /// Once everything that waits has been written.
    void shut(websocket::close_code code, const std::string& reason) {
        if (closing_ || !is_open_) return;
        closing_ = websocket::close_reason(code, reason.substr(0, 120));
        if (!is_writing_) finish();
    }

private:
    struct Message {
        std::string bytes;
        bool is_binary, is_replaceable;
    };

    void post(Message message) {
        asio::post(stream_.get_executor(), [self = shared_from_this(), message = std::move(message)]() mutable {
            self->enqueue(std::move(message));
        });
    }

    void enqueue(Message message) {
        if (!is_open_ || closing_) return;
        if (message.is_replaceable) {
            const std::size_t first = is_writing_ ? 1 : 0;  // the one that is under way stays
            for (std::size_t i = first; i < waiting_.size(); ++i)
                if (waiting_[i].is_replaceable) {
                    backlog_ -= waiting_[i].bytes.size();
                    waiting_.erase(waiting_.begin() + std::ptrdiff_t(i));
                    break;
                }
        }
        backlog_ += message.bytes.size();
        waiting_.push_back(std::move(message));
        if (backlog_ > largest_backlog) return beast::get_lowest_layer(stream_).close();  // it does not read at all
        if (!is_writing_) write();
    }

    void write() {
        is_writing_ = true;
        stream_.binary(waiting_.front().is_binary);
        stream_.async_write(
            asio::buffer(waiting_.front().bytes),
            [self = shared_from_this()](beast::error_code error, std::size_t) { self->written(error); });
    }

    void written(beast::error_code error) {
        is_writing_ = false;
        if (!waiting_.empty()) backlog_ -= waiting_.front().bytes.size(), waiting_.pop_front();
        if (error) return;  // the reading side hears of it too
        if (!waiting_.empty()) return write();
        if (closing_) finish();
    }

    void finish() {
        stream_.async_close(*closing_, [self = shared_from_this()](beast::error_code) {});
        timer_.expires_after(std::chrono::seconds(2));  // a page that does not answer is cut off
        timer_.async_wait([self = shared_from_this()](beast::error_code error) {
            if (!error) beast::get_lowest_layer(self->stream_).close();
        });
    }

    void read() {
        stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
            error ? self->ended() : self->heard();
        });
    }

    void heard() {
        if (!allowance_.take())
            shut(websocket::close_code::policy_error, "too many messages a second");
        else if (!stream_.got_text())
            shut(websocket::close_code::unknown_data, "only text is understood");
        else if (!closing_)
            listener_->hear(*this, {static_cast<const char*>(buffer_.data().data()), buffer_.size()});
        buffer_.consume(buffer_.size());
        if (buffer_.capacity() > 65536) buffer_.shrink_to_fit();
        read();
    }

    void ended() {
        is_open_ = false;
        timer_.cancel();
        waiting_.resize(is_writing_ ? 1 : 0);
        if (const auto listener = std::move(listener_)) listener->gone(*this);
        context_.sockets.erase(shared_from_this());
    }

    websocket::stream<beast::tcp_stream> stream_;
    asio::steady_timer timer_{stream_.get_executor()};
    Context& context_;
    beast::flat_buffer buffer_;
    std::shared_ptr<Listener> listener_;
    std::deque<Message> waiting_;
    std::size_t backlog_ = 0;
    bool is_writing_ = false, is_open_ = false;
    std::optional<websocket::close_reason> closing_;
    Allowance allowance_;
};

/// What every answer says: nothing is loaded from elsewhere, framed by others, guessed or kept.
template <class Message>
void add_headers(Message& message) {
    message.set(http::field::server, "chiaro");
    message.set(http::field::cache_control, "no-store");
    message.set("Content-Security-Policy",
                "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; "
                "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    message.set("X-Content-Type-Options", "nosniff");
    message.set("Referrer-Policy", "no-referrer");
    message.set("Cross-Origin-Opener-Policy", "same-origin");
    message.set("Cross-Origin-Resource-Policy", "same-origin");
}

/// One connection as long as it speaks HTTP.
class Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(tcp::socket socket, Context& context) : stream_(std::move(socket)), context_(context) {
        ++context_.connections;
    }
    ~Connection() { --context_.connections; }

    void read() {
        parser_.emplace();
        parser_->header_limit(16384);
        parser_->body_limit(largest_upload);
        stream_.expires_after(std::chrono::seconds(30));
        http::async_read_header(stream_, buffer_, *parser_,
                                [self = shared_from_this()](beast::error_code error, std::size_t) {
                                    if (!error) return self->header_read();
                                    if (error != http::error::end_of_stream && error != beast::error::timeout)
                                        self->refuse(400, "This is not HTTP as it is understood here.\n");
                                });
    }

private:
    std::string field(http::field name) const { return std::string(parser_->get()[name]); }

    void header_read() {
        const auto& header = parser_->get();
        if (!context_.doorman.lets_in(field(http::field::host), field(http::field::origin)))
            return refuse(403, "This server answers to its own address and its own page only.\n");
        request_ = request_of(std::string(header.method_string()), std::string(header.target()));
        if (request_.method != "GET" && request_.method != "HEAD" && request_.method != "POST")
            return refuse(405, "Only GET, HEAD and POST are understood.\n");
        const auto told = parser_->content_length();
        if (told && *told > (request_.method == "POST" ? largest_upload : 0))
            return refuse(413, fmt::format("A file may have at most {} MiB.\n", largest_upload >> 20));
        if (request_.method == "POST") {
            const Response admitted = context_.site.admit(request_);
            if (admitted.status != 200) return refuse(admitted.status, admitted.body);
            stream_.expires_after(std::chrono::seconds(300));
        }
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
            if (!error) return self->request_read();
            if (error == http::error::body_limit) self->refuse(413, "The file is too large.\n");
        });
    }

    void request_read() {
        if (websocket::is_upgrade(parser_->get())) return upgrade();
        request_.body = std::move(parser_->get().body());
        const bool with_body = request_.method != "HEAD";
        if (!with_body) request_.method = "GET";
        Response response = context_.site.answer(request_);
        response.file.empty() ? write_text(response, with_body) : write_file(response);
    }

    void upgrade() {
        const Response admitted = context_.site.admit(request_);
        if (admitted.status != 200) return refuse(admitted.status, admitted.body);
        if (context_.sockets.size() >= most_sockets) return refuse(503, "Too many pages are open.\n");
        stream_.expires_never();
        std::make_shared<WebSocket>(stream_.release_socket(), context_)->open(parser_->release(), request_);
    }

    void refuse(int status, const std::string& sentence) {
        keep_alive_ = false;
        Response response;
        response.status = status;
        response.body = sentence;
        write_text(response, true);
    }

    void write_text(const Response& response, bool with_body) {
        auto message = std::make_shared<http::response<http::string_body>>(http::status(response.status), 11);
        message->set(http::field::content_type, response.type);
        message->body() = response.body;
        message->prepare_payload();
        if (!with_body) message->body().clear();
        write(message);
    }

    void write_file(const Response& response) {
        beast::error_code error;
        http::file_body::value_type file;
        file.open(response.file.c_str(), beast::file_mode::scan, error);
        std::error_code ignored;
        std::filesystem::remove(response.file, ignored);  // it lives as long as it is open
        if (error) return refuse(404, "The picture is gone.\n");
        auto message = std::make_shared<http::response<http::file_body>>(http::status::ok, 11);
        message->body() = std::move(file);
        message->set(http::field::content_type, response.type);
        message->set(http::field::content_disposition, fmt::format("attachment; filename=\"{}\"", response.save_as));
        message->prepare_payload();
        stream_.expires_after(std::chrono::minutes(30));
        write(message);
    }

    template <class Message>
    void write(std::shared_ptr<Message> message) {
        add_headers(*message);
        message->keep_alive(keep_alive_ && parser_->get().keep_alive());
        http::async_write(stream_, *message,
                          [self = shared_from_this(), message](beast::error_code error, std::size_t) {
                              if (error) return;
                              if (message->keep_alive() && !self->context_.ending) return self->read();
                              beast::error_code ignored;
                              self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                          });
    }

    beast::tcp_stream stream_;
    Context& context_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    Request request_;
    bool keep_alive_ = true;
};

tcp::acceptor listening(asio::io_context& io, const Address& address) {
    boost::system::error_code error;
    tcp::resolver resolver(io);
    const auto found = resolver.resolve(address.host, std::to_string(address.port), error);
    if (error || found.empty())
        throw Error(ErrorCode::usage, fmt::format("--host {}: no address of this machine", address.host));
    const auto endpoint = found.begin()->endpoint();
    tcp::acceptor acceptor(io);
    const auto bind = [&](unsigned short port) {
        acceptor.open(endpoint.protocol());
        acceptor.set_option(tcp::acceptor::reuse_address(true));
        acceptor.bind({endpoint.address(), port}, error);
        if (!error) acceptor.listen(128, error);
        if (error) acceptor.close();
    };
    bind(endpoint.port());
    if (error == asio::error::address_in_use && address.or_another) bind(0);
    if (error)
        throw Error(ErrorCode::output,
                    fmt::format("{} port {}: cannot be served ({})", address.host, address.port, error.message()));
    return acceptor;
}

}  // namespace

struct Net::Impl {
    Impl(const Address& address, Site& site) : context(site, address.host), acceptor(listening(io, address)) {}

    void accept() {
        acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
            if (context.ending || error == asio::error::operation_aborted) return;
            if (!error && context.connections < most_connections) {
                beast::error_code ignored;
                socket.set_option(tcp::no_delay(true), ignored);
                std::make_shared<Connection>(std::move(socket), context)->read();
            }
            if (!error) return accept();
            timer_for_accept.expires_after(std::chrono::milliseconds(100));  // out of file descriptors
            timer_for_accept.async_wait([this](beast::error_code over) {
                if (!over) accept();
            });
        });
    }

    void tick() {
        timer.expires_after(std::chrono::seconds(5));
        timer.async_wait([this](beast::error_code error) {
            if (error) return;
            context.site.tick();
            tick();
        });
    }

    void end() {
        if (context.ending) return;
        context.ending = true;
        acceptor.close();
        timer.cancel();
        timer_for_accept.cancel();
        context.site.end();
        for (const auto& socket : std::set(context.sockets)) socket->close(websocket::close_code::going_away, "");
        last.expires_after(std::chrono::seconds(3));
        last.async_wait([this](beast::error_code) { io.stop(); });
        wait_for_sockets();
    }

    void wait_for_sockets() {
        if (context.sockets.empty()) return io.stop();
        timer.expires_after(std::chrono::milliseconds(20));
        timer.async_wait([this](beast::error_code) { wait_for_sockets(); });
    }

    Context context;  // outlives what `io` still holds when it ends
    asio::io_context io{1};
    tcp::acceptor acceptor;
    asio::steady_timer timer{io}, timer_for_accept{io}, last{io};
    asio::signal_set signals{io};
};

Net::Net(const Address& address, Site& site) : impl_(std::make_unique<Impl>(address, site)) {}

Net::~Net() = default;

int Net::port() const { return impl_->acceptor.local_endpoint().port(); }

void Net::run(bool signals) {
    Impl& net = *impl_;
    if (signals) {
        net.signals.add(SIGINT);
        net.signals.add(SIGTERM);
        net.signals.async_wait([&net](beast::error_code error, int) {
            if (!error) net.end();
        });
    }
    net.accept();
    net.tick();
    net.io.run();
    net.context.sockets.clear();
}

void Net::stop() {
    asio::post(impl_->io, [this] { impl_->end(); });
}

}  // namespace chiaro::server
