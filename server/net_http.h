// Part of net.cpp: a connection as long as it speaks HTTP.
#pragma once
#include <utility>  // which Boost 1.74 forgets

#include <fmt/format.h>

#include <limits>

#include "gzip.h"
#include "net_socket.h"

namespace chiaro::server {

inline constexpr std::size_t worth_packing = 1024;  // bytes
inline constexpr std::size_t largest_upload = 64 << 20, max_uploads = 4, max_sockets = 128;
inline constexpr std::size_t largest_read_away = 64 << 20;  // bytes
// A browser opens six connections to a server, and shows the token on the first.
inline constexpr std::size_t max_strangers = 64, max_strangers_of_address = 32;

/// What every answer says: nothing is loaded from elsewhere, framed by others than those named, guessed or kept.
template <class Message>
void add_headers(Message& message, const std::string& frame_ancestors) {
    message.set(http::field::server, "chiaro");
    message.set(http::field::cache_control, "no-store");
    message.set("Content-Security-Policy",
                "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; "
                "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors " +
                    frame_ancestors);
    message.set("X-Content-Type-Options", "nosniff");
    message.set("Referrer-Policy", "no-referrer");
    message.set("Cross-Origin-Opener-Policy", "same-origin");
    message.set("Cross-Origin-Resource-Policy", "same-origin");
}

class Connection : public std::enable_shared_from_this<Connection> {
public:
    Connection(tcp::socket socket, Context& context) : stream_(std::move(socket)), context_(context) {
        beast::error_code ignored;
        address_ = stream_.socket().remote_endpoint(ignored).address();
        make_room_for_strangers();
        ++context_.connections;
        context_.strangers.push_back(this);
    }
    ~Connection() {
        give_up_file();
        --context_.connections;
        context_.uploads -= is_upload_;
        if (!is_known_) context_.strangers.remove(this);
    }

    void read() {
        parser_.emplace();
        parser_->header_limit(16384);
        parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // until it is known where the body goes
        stream_.expires_after(std::chrono::seconds(is_known_ ? 30 : 10));
        http::async_read_header(stream_, buffer_, *parser_,
                                [self = shared_from_this()](beast::error_code error, std::size_t) {
                                    if (!error) return self->header_read();
                                    if (error != http::error::end_of_stream && error != beast::error::timeout)
                                        self->refuse(400, "This is not HTTP as it is understood here.\n");
                                });
    }

private:
    /// The oldest goes: one that waits for nothing but a page that has just come.
    void make_room_for_strangers() {
        auto& strangers = context_.strangers;
        const auto is_neighbour = [&](const Connection* other) { return other->address_ == address_; };
        const auto neighbours = std::size_t(std::count_if(strangers.begin(), strangers.end(), is_neighbour));
        const auto oldest = neighbours >= max_strangers_of_address
                                ? std::find_if(strangers.begin(), strangers.end(), is_neighbour)
                                : strangers.begin();
        if (neighbours < max_strangers_of_address && strangers.size() < max_strangers) return;
        (*oldest)->stream_.close();
        (*oldest)->is_known_ = true;  // to the list
        strangers.erase(oldest);
    }

    void get_to_know() {
        if (is_known_ || !context_.site.is_known(request_)) return;
        is_known_ = true;
        context_.strangers.remove(this);
    }

    std::string field(http::field name) const { return std::string(parser_->get()[name]); }

    /// Named, and not with the quality 0.
    bool accepts_gzip() const {
        const std::string accepted = field(http::field::accept_encoding);
        const std::size_t at = accepted.find("gzip");
        return at != accepted.npos && accepted.compare(at, 8, "gzip;q=0") != 0;
    }

    void header_read() {
        const auto& header = parser_->get();
        if (!context_.doorman.lets_in(field(http::field::host), field(http::field::origin)))
            return refuse(403, "This server answers to its own address and its own page only.\n");
        request_ = request_of(std::string(header.method_string()), std::string(header.target()));
        if (request_.method != "GET" && request_.method != "HEAD" && request_.method != "POST")
            return refuse(405, "Only GET, HEAD and POST are understood.\n");
        get_to_know();
        if (request_.method == "POST" ? !begin_upload() : !has_no_body()) return;
        if (!file_.empty()) return read_into_file();
        parser_->body_limit(largest_upload);
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
            if (!error) return self->request_read();
            if (error == http::error::body_limit) self->refuse(413, "The file is too large.\n");
        });
    }

    bool has_no_body() {
        if (!parser_->chunked() && parser_->content_length().value_or(0) == 0) return true;
        refuse(413, "Only a file that is sent has a body.\n");
        return false;
    }

    /// What a stranger sends is not read; of others, little at a time.
    bool begin_upload() {
        const Response admitted = context_.site.admit(request_);
        if (admitted.status != 200) return refuse(admitted.status, admitted.body), false;
        if (context_.uploads >= max_uploads) return refuse(503, "Too many files are being sent.\n"), false;
        request_.bytes = parser_->content_length().value_or(0);
        try {
            file_ = context_.site.destination(request_);
        } catch (const std::exception& error) {
            return refuse(413, std::string(error.what()) + "\n"), false;
        }
        if (file_.empty() && request_.bytes > largest_upload)
            return refuse(413, fmt::format("A file may have at most {} MiB.\n", largest_upload >> 20)), false;
        if (!file_.empty() && !parser_->content_length())
            return give_up_file(), refuse(411, "A file must state its length.\n"), false;
        ++context_.uploads, is_upload_ = true;
        stream_.expires_after(std::chrono::seconds(300));
        return true;
    }

    /// Never whole in memory: what comes goes to the file, as long as something comes.
    void read_into_file() {
        keep_alive_ = parser_->get().keep_alive();
        into_file_.emplace(std::move(*parser_));
        parser_.emplace();
        into_file_->body_limit(request_.bytes);
        beast::error_code error;
        into_file_->get().body().open(file_.c_str(), beast::file_mode::write_new, error);
        if (error) return refuse(507, "What is sent cannot be kept: " + error.message() + ".\n");
        read_more();
    }

    void read_more() {
        if (into_file_->is_done()) return file_read();
        stream_.expires_after(std::chrono::seconds(60));
        http::async_read_some(stream_, buffer_, *into_file_,
                              [self = shared_from_this()](beast::error_code error, std::size_t) {
                                  if (!error) return self->read_more();
                                  if (error == beast::errc::no_space_on_device) {
                                      self->give_up_file();
                                      self->refuse(507, "The disk is full.\n");
                                  }
                              });
    }

    void file_read() {
        into_file_.reset();  // which closes the file
        file_.clear();
        request_read();
    }

    /// A file that did not come whole goes.
    void give_up_file() {
        if (file_.empty()) return;
        into_file_.reset();
        std::error_code ignored;
        std::filesystem::remove(file_, ignored);
        file_.clear();
        context_.site.abandon(request_);
    }

    void request_read() {
        if (websocket::is_upgrade(parser_->get())) return upgrade();
        request_.body = std::move(parser_->get().body());
        with_body_ = request_.method != "HEAD";
        if (!with_body_) request_.method = "GET";
        const auto come_back = [self = weak_from_this()](const Response& response) {
            const auto connection = self.lock();
            if (!connection) return;
            connection->context_.answered_later.erase(connection);
            connection->respond(response);
        };
        const auto later = [mailbox = context_.mailbox, come_back](Response response) {
            mailbox->post([come_back, response = std::move(response)] { come_back(response); });
        };
        try {
            if (const auto response = context_.site.answer(std::move(request_), later)) return respond(*response);
        } catch (const std::exception& error) {  // memory, a full disk
            return refuse(500, std::string(error.what()) + "\n");
        }
        context_.answered_later.insert(shared_from_this());
    }

    void respond(const Response& response) {
        if (is_upload_) --context_.uploads, is_upload_ = false;
        response.file.empty() ? write_text(response, with_body_) : write_file(response);
    }

    void upgrade() {
        const Response admitted = context_.site.admit(request_);
        if (admitted.status != 200) return refuse(admitted.status, admitted.body);
        if (context_.sockets.size() >= max_sockets) return refuse(503, "Too many pages are open.\n");
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
        message->set(http::field::vary, "Accept-Encoding");
        if (response.body.size() >= worth_packing && accepts_gzip()) {
            message->set(http::field::content_encoding, "gzip");
            message->body() = gzip(response.body);
        } else {
            message->body() = response.body;
        }
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
        add_headers(*message, context_.frame_ancestors);
        message->keep_alive(keep_alive_ && parser_->get().keep_alive());
        http::async_write(stream_, *message,
                          [self = shared_from_this(), message](beast::error_code error, std::size_t) {
                              if (error) return;
                              if (message->keep_alive() && !self->context_.ending) return self->read();
                              beast::error_code ignored;
                              self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                              self->stream_.expires_after(std::chrono::seconds(2));
                              self->read_away(largest_read_away);
                          });
    }

    /// What still comes of a request that was refused: were it left unread, the answer would be lost with it.
    void read_away(std::size_t most) {
        buffer_.consume(buffer_.size());
        stream_.async_read_some(buffer_.prepare(65536),
                                [self = shared_from_this(), most](beast::error_code error, std::size_t count) {
                                    if (!error && count < most) self->read_away(most - count);
                                });
    }

    beast::tcp_stream stream_;
    Context& context_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    std::optional<http::request_parser<http::file_body>> into_file_;
    std::filesystem::path file_;  ///< that the body goes to
    Request request_;
    asio::ip::address address_;
    bool keep_alive_ = true, with_body_ = true;
    bool is_known_ = false;   ///< has shown a token
    bool is_upload_ = false;  ///< counted among the uploads
};

}  // namespace chiaro::server
