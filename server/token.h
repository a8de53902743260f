// Secrets.
#pragma once
#include <string>

namespace chiaro::server {

/// 128 bits from the system's random numbers, as 32 hexadecimal digits.
std::string random_key();

/// The key of this user's server at a port: that of CHIARO_VIEW_TOKEN, the one kept in the user's state folder (mode
/// 0600), or a new one, which is kept where that can be done - so that a page finds its server after a restart.
std::string token_for(int port);

/// Compares in a time that tells nothing.
bool is_same_key(const std::string& a, const std::string& b);

}  // namespace chiaro::server
