// What chiaro-fetch may use of the machine.
#pragma once
#include <string>

#include "decode/limits.h"

namespace chiaro::fetch {

/// Sockets of the internet, and no file but those that say who may sign certificates, `certificates` among them, and by
/// what names of hosts are looked up.
decode::Limits limits_with(const std::string& certificates);

}  // namespace chiaro::fetch
