#include "fetch/address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace chiaro::fetch {
namespace {

struct Net {
    std::uint32_t address;
    int bits;
};

bool is_private(std::uint32_t address) {
    constexpr std::array nets{Net{0x00000000, 8},  Net{0x0a000000, 8},  Net{0x64400000, 10}, Net{0x7f000000, 8},
                              Net{0xa9fe0000, 16}, Net{0xac100000, 12}, Net{0xc0000000, 24}, Net{0xc0a80000, 16},
                              Net{0xc6120000, 15}, Net{0xe0000000, 3}};
    return std::ranges::any_of(nets, [&](const Net& net) { return (address ^ net.address) >> (32 - net.bits) == 0; });
}

bool is_private(const in6_addr& address) {
    const std::uint8_t* b = address.s6_addr;
    const auto inner = [&](int at) {  // an address of version 4 in it
        return is_private(std::uint32_t(b[at]) << 24 | std::uint32_t(b[at + 1]) << 16 | std::uint32_t(b[at + 2]) << 8 |
                          b[at + 3]);
    };
    if (IN6_IS_ADDR_V4MAPPED(&address) || IN6_IS_ADDR_V4COMPAT(&address)) return inner(12);  // ::1 is 0.0.0.1 there
    if (b[0] == 0x00 && b[1] == 0x64 && b[2] == 0xff && b[3] == 0x9b) return inner(12);      // 64:ff9b::/96
    if (b[0] == 0x20 && b[1] == 0x02) return inner(2);                                       // 2002::/16
    return (b[0] & 0xe0) != 0x20;  // all that is global is 2000::/3
}

}  // namespace

bool is_private(const sockaddr* address) {
    if (address->sa_family == AF_INET) {
        sockaddr_in four{};
        std::memcpy(&four, address, sizeof four);
        return is_private(ntohl(four.sin_addr.s_addr));
    }
    if (address->sa_family != AF_INET6) return true;
    sockaddr_in6 six{};
    std::memcpy(&six, address, sizeof six);
    return is_private(six.sin6_addr);
}

}  // namespace chiaro::fetch
