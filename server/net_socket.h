// Part of net.cpp: a page's connection.
#pragma once
#include <utility>  // which Boost 1.74 forgets

#include <boost/beast.hpp>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <set>

#include "net_guard.h"

namespace chiaro::server {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

inline constexpr std::size_t largest_message = 1 << 20, largest_backlog = 256 << 20;

class WebSocket;
class Connection;

struct Context {
    Context(Site& served, const Address& address, asio::io_context& io)
        : site(served), doorman(address), mailbox(std::make_shared<Mailbox>(io)) {
        for (const std::string& origin : address.embed_from)
            frame_ancestors += (frame_ancestors.empty() ? "" : " ") + origin;
        if (frame_ancestors.empty()) frame_ancestors = "'none'";
    }

    Site& site;
    Doorman doorman;
    std::string frame_ancestors;  ///< of the Content-Security-Policy
    const std::shared_ptr<Mailbox> mailbox;
    std::size_t connections = 0, uploads = 0;
    std::set<std::shared_ptr<Connection>> answered_later;
    std::list<Connection*> strangers;  ///< connections that have not shown a token, the oldest first
    std::set<std::shared_ptr<WebSocket>> sockets;
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

    /// There is no connection any more, or none will be served.
    void ended() {
        is_open_ = false;
        timer_.cancel();
        waiting_.resize(is_writing_ ? 1 : 0);
        if (const auto listener = std::move(listener_)) listener->gone(*this);
        context_.sockets.erase(shared_from_this());
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
        std::string text(static_cast<const char*>(buffer_.data().data()), buffer_.size());
        buffer_.consume(buffer_.size());
        if (buffer_.capacity() > 65536) buffer_.shrink_to_fit();
        if (closing_) return read();
        const auto read_on = [self = weak_from_this()] {
            if (const auto socket = self.lock(); socket && socket->is_open_) socket->read();
        };
        listener_->hear(*this, std::move(text), [mailbox = context_.mailbox, read_on] { mailbox->post(read_on); });
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

}  // namespace chiaro::server
