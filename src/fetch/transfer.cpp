#include "fetch/transfer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <new>

#include "fetch/address.h"

namespace chiaro::fetch {
namespace {

constexpr int max_redirects = 5, max_tries = 4;
constexpr double last_try_seconds = 8;  // after which none begins: who waits gives up after 15
constexpr long connect_ms = 4000, silent_seconds = 5, least_bytes_a_second = 200;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

/// "bytes FIRST-LAST/SIZE".
struct ContentRange {
    std::uint64_t first = 0, last = 0, size = 0;
};
std::optional<ContentRange> content_range_from(const std::string& text) {
    ContentRange range;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto take = [&](std::string_view before, std::uint64_t& number) {
        if (!std::string_view(at, std::size_t(end - at)).starts_with(before)) return false;
        const auto [next, error] = std::from_chars(at + before.size(), end, number);
        at = next;
        return error == std::errc();
    };
    if (!take("bytes ", range.first) || !take("-", range.last) || !take("/", range.size) || at != end) return {};
    return range;
}

std::string printable(std::string text, std::size_t most = 80) {
    text.resize(std::min(text.size(), most));
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 32 || c > 126; }, '?');
    return text;
}

}  // namespace

Transfer::Transfer(CURLM* multi, const Server& server, Request request)
    : multi_(multi), easy_(curl_easy_init()), server_(server), request_(std::move(request)) {
    if (!easy_) throw std::bad_alloc();
    url_ = server_.url_of(request_.path);
    begin();
}

Transfer::~Transfer() {
    if (is_running_) curl_multi_remove_handle(multi_, easy_);
    curl_easy_cleanup(easy_);
    curl_slist_free_all(headers_);
}

bool Transfer::is_at_home() const { return origin_of(url_) == origin_of(server_.url); }

void Transfer::begin() {
    body_.clear(), refusal_.clear(), got_ = {};
    curl_easy_reset(easy_);
    const auto set = [this](CURLoption option, auto value) { curl_easy_setopt(easy_, option, value); };
    set(CURLOPT_URL, url_.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_PROXY, "");
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_HTTP_VERSION, long(CURL_HTTP_VERSION_1_1));
    set(CURLOPT_USERAGENT, "chiaro-fetch");
    set(CURLOPT_CONNECTTIMEOUT_MS, connect_ms);
    set(CURLOPT_LOW_SPEED_LIMIT, least_bytes_a_second);
    set(CURLOPT_LOW_SPEED_TIME, silent_seconds);
    set(CURLOPT_WRITEFUNCTION, &Transfer::take_body);
    set(CURLOPT_WRITEDATA, this);
    set(CURLOPT_HEADERFUNCTION, &Transfer::take_header);
    set(CURLOPT_HEADERDATA, this);
    set(CURLOPT_OPENSOCKETFUNCTION, &Transfer::open_socket);
    set(CURLOPT_OPENSOCKETDATA, this);
    set(CURLOPT_PRIVATE, this);
    if (!server_.certificates.empty()) set(CURLOPT_CAINFO, server_.certificates.c_str());
    const Part& part = request_.part;
    if (part.kind == Part::Kind::range)
        set(CURLOPT_RANGE, fmt::format("{}-{}", part.first, part.first + part.bytes - 1).c_str());
    if (part.kind == Part::Kind::last) set(CURLOPT_RANGE, fmt::format("-{}", part.bytes).c_str());
    curl_slist_free_all(headers_);
    headers_ = nullptr;
    if (is_at_home())
        for (const std::string& header : server_.headers) headers_ = curl_slist_append(headers_, header.c_str());
    if (request_.unless && request_.unless != "-")
        headers_ = curl_slist_append(headers_, ("If-None-Match: " + *request_.unless).c_str());
    set(CURLOPT_HTTPHEADER, headers_);
    is_running_ = curl_multi_add_handle(multi_, easy_) == CURLM_OK;
    if (!is_running_) fault("cannot be fetched: no request can be made");
}

void Transfer::wake() {
    if (!is_running_ && answer_.empty() && Clock::now() >= next_try_) begin();
}

void Transfer::fault(const std::string& sentence) {
    body_.clear();
    answer_ = fmt::format("fault {}\n", printable(sentence, 1000));
}

std::size_t Transfer::take_body(char* bytes, std::size_t one, std::size_t count, void* self) {
    auto& transfer = *static_cast<Transfer*>(self);
    const std::size_t more = one * count;
    long status = 0;
    curl_easy_getinfo(transfer.easy_, CURLINFO_RESPONSE_CODE, &status);
    if (status != 200 && status != 206) return more;  // of no interest
    if (more > transfer.request_.part.bytes - transfer.body_.size()) {
        transfer.refusal_ =
            status == 200 && transfer.request_.part.kind != Part::Kind::all
                ? "its server sends whole files where a part is asked for, so it cannot be read"
                : fmt::format("its server sends more than the {} bytes that can be", transfer.request_.part.bytes);
        return 0;
    }
    try {
        transfer.body_.append(bytes, more);
    } catch (const std::bad_alloc&) {
        transfer.refusal_ = "fetching it takes more memory than is permitted";
        return 0;
    }
    return more;
}

std::size_t Transfer::take_header(char* bytes, std::size_t one, std::size_t count, void* self) {
    constexpr std::size_t most = 1 << 16;
    auto& transfer = *static_cast<Transfer*>(self);
    Headers& got = transfer.got_;
    std::string_view line(bytes, one * count);
    if (line.starts_with("HTTP/")) got = {};
    if ((got.bytes += line.size()) > most) {
        transfer.refusal_ = "its server sends headers without end";
        return 0;
    }
    const auto colon = line.find(':');
    if (colon == line.npos) return line.size();
    std::string name(line.substr(0, colon)), value(line.substr(colon + 1));
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    const auto begin = value.find_first_not_of(" \t"), end = value.find_last_not_of(" \t\r\n");
    value = begin == value.npos ? "" : value.substr(begin, end + 1 - begin);
    if (name == "content-range") got.range = value;
    if (name == "content-encoding") got.encoding = value;
    if (name == "etag") got.tag = value;
    if (name == "retry-after") got.retry_after = std::atof(value.c_str());
    return line.size();
}

curl_socket_t Transfer::open_socket(void* self, curlsocktype, curl_sockaddr* address) {
    auto& transfer = *static_cast<Transfer*>(self);
    if (is_private(&address->addr) && !(transfer.server_.may_be_private && transfer.is_at_home())) {
        transfer.refusal_ = fmt::format(
            "'{}' is in a private net or this machine, where only what the command line names is looked for",
            origin_of(transfer.url_));
        return CURL_SOCKET_BAD;
    }
    return socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
}

void Transfer::end(CURLcode result) {
    curl_multi_remove_handle(multi_, easy_);
    is_running_ = false;
    ++tries_;
    if (!refusal_.empty()) return fault(refusal_);
    long status = 0;
    curl_easy_getinfo(easy_, CURLINFO_RESPONSE_CODE, &status);
    switch (result) {
        case CURLE_OK:
            return take_answer(status);
        case CURLE_COULDNT_RESOLVE_HOST:
            return fault(fmt::format("there is no host of the name in '{}'", origin_of(url_)));
        case CURLE_COULDNT_CONNECT:
            return try_again("its server cannot be reached");
        case CURLE_OPERATION_TIMEDOUT:
            return try_again("its server does not answer, or is too slow");
        case CURLE_PARTIAL_FILE:
        case CURLE_GOT_NOTHING:
        case CURLE_RECV_ERROR:
        case CURLE_SEND_ERROR:
            return try_again("its server ends the connection half-way");
        case CURLE_PEER_FAILED_VERIFICATION:
            return fault("its server cannot prove to be what it says (its certificate is not trusted)");
        default:
            return fault(fmt::format("its server cannot be understood ({})", curl_easy_strerror(result)));
    }
}

void Transfer::take_answer(long status) {
    using enum Part::Kind;
    if (status == 404 || status == 410 || status == 403) {
        answer_ = fmt::format("none {}\n", status);
    } else if (status == 304 && request_.unless && request_.unless != "-") {
        if (is_known(*request_.unless)) answer_ = "same\n";
    } else if (status >= 300 && status < 400) {
        redirect();
    } else if (status == 429 || status >= 500) {
        try_again(fmt::format("its server answers {}", status));
    } else if (status == 401) {
        fault("its server asks who you are; CHIARO_HTTP_TOKEN or CHIARO_HTTP_HEADERS may tell it");
    } else if (status == 416) {
        fault("has fewer bytes than its index says: it was cut, or is damaged");
    } else if (status == 200 && request_.part.kind != all) {
        fault("its server sends whole files where a part is asked for, so it cannot be read");
    } else if (status != 200 && !(status == 206 && request_.part.kind != all)) {
        fault(fmt::format("its server answers {}", status));
    } else if (!got_.encoding.empty() && got_.encoding != "identity") {
        fault(fmt::format("its server packs what it sends by '{}', which it was not asked for", got_.encoding));
    } else {
        take_part();
    }
}

void Transfer::take_part() {
    const Part& part = request_.part;
    std::uint64_t size = body_.size();
    if (part.kind != Part::Kind::all) {
        const auto range = content_range_from(got_.range);
        std::uint64_t first = part.first, bytes = part.bytes;
        if (range && part.kind == Part::Kind::last) {
            bytes = std::min(bytes, range->size);
            first = range->size - bytes;
        }
        if (!range || range->first != first || range->last != first + bytes - 1 || range->last >= range->size ||
            body_.size() != bytes)
            return fault(
                fmt::format("its server sends other bytes than were asked for ({} of '{}')", body_.size(), got_.range));
        size = range->size;
        if (!is_known(got_.tag)) return;
    }
    answer_ = fmt::format("part {} {}", body_.size(), size);
    if (request_.unless) answer_ += is_strong(got_.tag) ? " " + got_.tag : " -";
    answer_ += "\n";
}

/// Whether it stands for the contents of a file of which other parts were read; a fault where not.
bool Transfer::is_known(const std::string& tag) {
    const auto [known, is_new] = server_.tags.try_emplace(request_.path, tag);
    if (known->second != tag) fault("it has changed on its server while it was read");
    return known->second == tag;
}

void Transfer::redirect() {
    const char* to = nullptr;
    curl_easy_getinfo(easy_, CURLINFO_REDIRECT_URL, &to);
    if (!to) return fault("its server redirects to nowhere");
    if (++redirects_ > max_redirects)
        return fault(fmt::format("its server redirects more than {} times", max_redirects));
    const std::string next = to;
    if (!next.starts_with("http://") && !next.starts_with("https://"))
        return fault(fmt::format("its server redirects to '{}', which is neither http nor https", next));
    if (url_.starts_with("https://") && next.starts_with("http://"))
        return fault("its server redirects from https to http, which anybody can read and change");
    url_ = next;
    begin();
}

/// Half a second later, a second later, and so on, while somebody waits.
void Transfer::try_again(const std::string& sentence) {
    const double pause = std::max(0.25 * double(1 << tries_), got_.retry_after);
    if (tries_ >= max_tries || seconds_since(start_) + pause > last_try_seconds)
        return fault(fmt::format("{} ({} tr{})", sentence, tries_, tries_ > 1 ? "ies" : "y"));
    next_try_ = Clock::now() + std::chrono::milliseconds(std::int64_t(1000 * pause));
}

}  // namespace chiaro::fetch
