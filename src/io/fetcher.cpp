#include "io/fetcher.h"

#include <chiaro/error.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "core/text.h"

namespace chiaro {

std::string checked_url(const std::string& url) {
    const auto refuse = [&](const char* why) {
        throw Error(ErrorCode::input, "cannot read '" + one_line(url) + "': " + why);
    };
    const auto host = url.find("://") + 3, path = std::min(url.find('/', host), url.size());
    const std::string authority = url.substr(host, path - host);
    if (authority.empty()) refuse("the address names no host");
    if (authority.find('@') != authority.npos)
        refuse("an address with a name and a password is not taken; CHIARO_HTTP_HEADERS says who you are");
    if (url.find_first_of("?#") != url.npos) refuse("an address with ? or # is not taken, as files lie below it");
    if (std::ranges::any_of(url, [](unsigned char c) { return c <= 32 || c >= 127; }))
        refuse("an address holds letters without accents, and neither blanks nor control characters (%20)");
    return url.substr(0, url.find_last_not_of('/') + 1);
}

Fetcher::Fetcher(const std::string& url, bool may_be_private) : url_(url), cache_(HttpCache::of_environment()) {
    auto [ours, theirs] = make_connection();
    control_ = std::move(ours);
    process_ = std::make_unique<HelperProcess>(find_helper("chiaro-fetch"),
                                               std::vector<std::string>{url, may_be_private ? "named" : "public"},
                                               HandedOver{.standard_input = theirs.number()});
}

Descriptor Fetcher::connection() {
    auto [ours, theirs] = make_connection();
    hand_over(theirs);
    if (!cache_) return std::move(ours);
    auto [relays, decoders] = make_connection();
    std::erase_if(relays_, [](const auto& relay) { return relay->has_ended(); });
    relays_.push_back(std::make_unique<HttpRelay>(cache_, url_, std::move(relays), std::move(ours)));
    return std::move(decoders);
}

/// The program that fetches listens there from now on.
void Fetcher::hand_over(const Descriptor& end) {
    char byte = 0;
    iovec piece{&byte, 1};
    alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))] = {};
    msghdr message{};
    message.msg_iov = &piece, message.msg_iovlen = 1;
    message.msg_control = room, message.msg_controllen = sizeof room;
    cmsghdr* head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET, head->cmsg_type = SCM_RIGHTS, head->cmsg_len = CMSG_LEN(sizeof(int));
    const int number = end.number();
    std::memcpy(CMSG_DATA(head), &number, sizeof number);
    if (sendmsg(control_.number(), &message, MSG_NOSIGNAL) != 1)
        throw Error(ErrorCode::output, "cannot reach the program that fetches");
}

bool Fetcher::has_ended() const {
    pollfd waiting{control_.number(), POLLIN, 0};
    return poll(&waiting, 1, 0) > 0;  // it says nothing there
}

}  // namespace chiaro
