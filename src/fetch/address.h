// Which addresses of the internet are this machine's own, or those of a private net.
#pragma once
#include <sys/socket.h>

namespace chiaro::fetch {

/// Loopback, private, link-local, shared, multicast, reserved and unspecified ones, those of version 4 within version 6
/// included, and whatever is no address of the internet (RFC 6890).
bool is_private(const sockaddr* address);

}  // namespace chiaro::fetch
