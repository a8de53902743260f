// The only unit that knows Boost.Beast: connections, their limits, and who may connect from where.
#include "net.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include "net_http.h"

namespace chiaro::server {
namespace {

constexpr std::size_t max_connections = 192;

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
    Impl(const Address& address, Site& site) : context(site, address, io), acceptor(listening(io, address)) {}

    void accept() {
        acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
            if (context.ending || error == asio::error::operation_aborted) return;
            if (!error && context.connections < max_connections) {
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
    // Those that did not close in time: their pages count as gone, or work that goes on would answer into what ends.
    net.context.mailbox->close();
    for (const auto& socket : std::set(net.context.sockets)) socket->ended();
    net.context.answered_later.clear();
}

void Net::post(std::function<void()> work) { impl_->context.mailbox->post(std::move(work)); }

void Net::stop() {
    asio::post(impl_->io, [this] { impl_->end(); });
}

}  // namespace chiaro::server
