// Part of net.cpp: what is asked for, by whom, and how often.
#pragma once
#include <utility>  // which Boost 1.74 forgets

#include <algorithm>
#include <boost/asio.hpp>
#include <chrono>
#include <mutex>
#include <set>
#include <string>

#include "net.h"

namespace chiaro::server {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

inline constexpr double burst = 400, messages_per_second = 200;

inline int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

inline std::string decoded(std::string_view text) {
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

inline Request request_of(std::string_view method, std::string_view target) {
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
inline std::string host_name(std::string_view host) {
    const std::size_t colon = host.rfind(':'), bracket = host.rfind(']');
    const bool has_port = colon != host.npos && (bracket == host.npos || bracket < colon);
    return std::string(has_port ? host.substr(0, colon) : host);
}

inline bool is_address(const std::string& name) {
    const bool bracketed = name.size() > 2 && name.front() == '[' && name.back() == ']';
    boost::system::error_code error;
    asio::ip::make_address(bracketed ? name.substr(1, name.size() - 2) : name, error);
    return !error;
}

/// Against pages of others that have a browser ask this server: the name that was asked for must be one of ours (DNS
/// rebinding), and a page that asks must come from here, or from an origin that the server was told of: behind a proxy
/// the page has that origin, and its name may be the one asked for.
class Doorman {
public:
    explicit Doorman(const Address& address) : names_{"localhost", "127.0.0.1", "[::1]"} {
        const std::string& host = address.host;
        boost::system::error_code error;
        const auto bound = asio::ip::make_address(host, error);
        is_everywhere_ = !error && bound.is_unspecified();
        names_.insert(!error && bound.is_v6() ? "[" + host + "]" : host);
        if (is_everywhere_) names_.insert(asio::ip::host_name());
        for (const std::string& origin : address.embed_from) {
            origins_.insert(origin);
            names_.insert(host_name(std::string_view(origin).substr(origin.find("://") + 3)));
        }
    }

    bool lets_in(std::string_view host, std::string_view origin) const {
        const std::string name = host_name(host);
        const bool is_ours = names_.count(name) || (is_everywhere_ && is_address(name));
        return is_ours &&
               (origin.empty() || origin == "http://" + std::string(host) || origins_.count(std::string(origin)));
    }

private:
    std::set<std::string> names_, origins_;
    bool is_everywhere_;
};

/// From any thread to the network's; nowhere once that has ended.
class Mailbox {
public:
    explicit Mailbox(asio::io_context& io) : io_(&io) {}
    void post(std::function<void()> work) {
        const std::lock_guard lock(mutex_);
        if (io_) asio::post(*io_, std::move(work));
    }
    void close() {
        const std::lock_guard lock(mutex_);
        io_ = nullptr;
    }

private:
    std::mutex mutex_;
    asio::io_context* io_;
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

}  // namespace chiaro::server
