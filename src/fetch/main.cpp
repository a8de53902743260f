// chiaro-fetch: the one program that speaks to servers. It knows HTTP and nothing else, and reads no file of its
// user's.
//
//   chiaro-fetch URL named|public
//
// Started by the library (io/fetcher.cpp), which sends it connections over its standard input, a socket. On each
// somebody asks for files below the URL (io/wire.h). With `named` the URL's host may be of a private net.
#include <curl/curl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <cerrno>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "fetch/limits.h"
#include "fetch/server.h"
#include "fetch/transfer.h"

namespace chiaro::fetch {
namespace {

constexpr std::size_t max_clients = 32, longest_request = 1 << 14;
constexpr long max_requests = 8;  // at a time, each on a connection that stays open

/// Who asks, one request at a time.
struct Client {
    int connection = -1;
    std::string received, request, to_send;
    std::size_t sent = 0, told = 0;
    std::optional<Transfer> transfer;

    explicit Client(int number) : connection(number) {}
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;
    ~Client() { close(connection); }
};

/// The next connection; -1: there is none to come.
int received_connection() {
    char byte = 0;
    iovec piece{&byte, 1};
    alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))] = {};
    msghdr message{};
    message.msg_iov = &piece, message.msg_iovlen = 1;
    message.msg_control = room, message.msg_controllen = sizeof room;
    if (recvmsg(STDIN_FILENO, &message, MSG_CMSG_CLOEXEC) <= 0) return -1;
    const cmsghdr* head = CMSG_FIRSTHDR(&message);
    int number = -1;
    if (head && head->cmsg_level == SOL_SOCKET && head->cmsg_type == SCM_RIGHTS)
        std::memcpy(&number, CMSG_DATA(head), sizeof number);
    return number;
}

class Loop {
public:
    explicit Loop(Server server) : server_(std::move(server)), multi_(curl_multi_init()) {
        curl_multi_setopt(multi_, CURLMOPT_MAX_TOTAL_CONNECTIONS, max_requests);
    }
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;
    ~Loop() {
        clients_.clear();
        curl_multi_cleanup(multi_);
    }

    /// Until who started this program is gone.
    void run() {
        for (bool goes_on = true; goes_on;) {
            advance();
            goes_on = wait();
        }
    }

private:
    void advance() {
        int running = 0, left = 0;
        curl_multi_perform(multi_, &running);
        while (const CURLMsg* message = curl_multi_info_read(multi_, &left)) {
            if (message->msg != CURLMSG_DONE) continue;
            const CURLcode result = message->data.result;
            Transfer* transfer = nullptr;
            curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &transfer);
            transfer->end(result);
        }
        const bool tells = Clock::now() - last_told_ > std::chrono::milliseconds(300);
        if (tells) last_told_ = Clock::now();
        for (const auto& client : clients_) {
            auto& transfer = client->transfer;
            if (!transfer) continue;
            transfer->wake();
            if (!transfer->answer().empty()) {
                client->to_send += transfer->answer() + transfer->body();
                keep(client->request, *transfer);
                transfer.reset();
            } else if (tells && transfer->received() != client->told) {
                client->to_send += "wait\n";
                client->told = transfer->received();
            }
        }
    }

    void keep(const std::string& line, const Transfer& transfer) {
        constexpr std::size_t most = 10000, largest = 1 << 20;
        const Request& request = transfer.request();
        if (!is_metadata(request.path) || transfer.body().size() > largest || server_.metadata.size() >= most ||
            transfer.answer().starts_with("fault"))
            return;
        server_.metadata.emplace(line, transfer.answer() + transfer.body());
        if (request.unless && is_strong(transfer.tag()))  // who asks next has it already
            server_.metadata.emplace(
                "unless " + transfer.tag() + line.substr(line.find(' ', std::string_view("unless ").size())), "same\n");
    }

    bool wait() {
        std::vector<curl_waitfd> waiting{{STDIN_FILENO, CURL_WAIT_POLLIN, 0}};
        for (const auto& client : clients_)
            waiting.push_back({client->connection,
                               short(client->to_send.empty() ? CURL_WAIT_POLLIN : CURL_WAIT_POLLIN | CURL_WAIT_POLLOUT),
                               0});
        curl_multi_poll(multi_, waiting.data(), unsigned(waiting.size()), 100, nullptr);
        std::erase_if(clients_, [&, at = std::size_t(1)](const auto& client) mutable {
            return waiting[at++].revents != 0 && !serve(*client);
        });
        if (waiting[0].revents == 0) return true;
        const int connection = received_connection();
        if (connection < 0) return false;
        clients_.push_back(std::make_unique<Client>(connection));
        if (clients_.size() > max_clients) clients_.erase(clients_.begin());
        return true;
    }

    /// False where nobody is there any more, or what is said makes no sense.
    bool serve(Client& client) {
        while (client.sent < client.to_send.size()) {
            const ssize_t n = send(client.connection, client.to_send.data() + client.sent,
                                   client.to_send.size() - client.sent, MSG_DONTWAIT | MSG_NOSIGNAL);
            if (n < 0 && (errno == EAGAIN || errno == EINTR)) break;
            if (n <= 0) return false;
            client.sent += std::size_t(n);
        }
        if (client.sent == client.to_send.size()) client.to_send = std::string(), client.sent = 0;
        char piece[4096];
        const ssize_t n = recv(client.connection, piece, sizeof piece, MSG_DONTWAIT);
        if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) return false;
        if (n > 0) client.received.append(piece, std::size_t(n));
        const auto end = client.received.find('\n');
        if (end == std::string::npos) return client.received.size() < longest_request;
        client.request = client.received.substr(0, end);
        client.received.erase(0, end + 1);
        const auto request = request_from(client.request);
        if (!request || client.transfer) return false;
        client.told = 0;
        if (const auto known = server_.metadata.find(client.request); known != server_.metadata.end()) {
            client.to_send = known->second;
            return true;
        }
        client.transfer.emplace(multi_, server_, *request);
        return true;
    }

    Server server_;
    CURLM* multi_;
    std::vector<std::unique_ptr<Client>> clients_;
    Clock::time_point last_told_{};
};

}  // namespace
}  // namespace chiaro::fetch

int main(int argc, char** argv) {
    using namespace chiaro;
    if (argc != 3 || isatty(STDIN_FILENO)) {
        std::fputs("chiaro-fetch is started by chiaro; it does nothing on its own\n", stderr);
        return 2;
    }
    const char* stated = std::getenv("SSL_CERT_FILE");
    fetch::Server server{argv[1], std::strcmp(argv[2], "named") == 0, fetch::headers_from_environment(),
                         stated ? stated : ""};
    curl_global_init(CURL_GLOBAL_DEFAULT);
    decode::limit_this_process(fetch::limits_with(server.certificates));
    try {
        fetch::Loop(std::move(server)).run();
    } catch (const std::bad_alloc&) {
        return 1;
    }
    return 0;
}
