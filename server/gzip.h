// Text made smaller for the way to a far page.
#pragma once
#include <string>
#include <string_view>

namespace chiaro::server {

/// A gzip member (RFC 1952) that holds the bytes.
std::string gzip(std::string_view bytes);

}  // namespace chiaro::server
