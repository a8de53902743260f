#include "fetch/limits.h"

namespace chiaro::fetch {

decode::Limits limits_with(const std::string& certificates) {
    decode::Limits limits;
    limits.max_bytes = std::uint64_t(4) << 30;
    limits.is_by_request = true, limits.cpu_seconds = 1u << 30;
    limits.permissions.reads_all = false;
    limits.permissions.network = true;
    limits.permissions.readable = {"/etc/ssl/certs",
                                   "/etc/ssl/openssl.cnf",
                                   "/usr/share/ca-certificates",
                                   "/usr/local/share/ca-certificates",
                                   "/etc/resolv.conf",
                                   "/etc/hosts",
                                   "/etc/host.conf",
                                   "/etc/nsswitch.conf",
                                   "/etc/gai.conf"};
    if (!certificates.empty()) limits.permissions.readable.push_back(certificates);
    return limits;
}

}  // namespace chiaro::fetch
