// chiaro-fetch, which alone opens connections, seen from the library.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/helper_process.h"
#include "io/http_relay.h"

namespace chiaro {

/// "http://HOST/PATH", without '/' at the end. Throws Error{input} for an address with a name and a password, with ?
/// or #, or that is none.
std::string checked_url(const std::string& url);

/// The program for one address; ends with the thread that started it.
class Fetcher {
public:
    /// `may_be_private`: the address's host may be this machine, or in a private net. Throws Error{output} where the
    /// program cannot be started, Error{internal} where it is not installed, and as HttpCache::of_environment.
    Fetcher(const std::string& url, bool may_be_private);

    /// A connection over which a decoder may ask. Throws Error{output}.
    Descriptor connection();
    /// Whether it has crashed, say.
    bool has_ended() const;

private:
    void hand_over(const Descriptor& end);

    const std::string url_;
    const std::shared_ptr<HttpCache> cache_;
    Descriptor control_;
    std::unique_ptr<HelperProcess> process_;
    std::vector<std::unique_ptr<HttpRelay>> relays_;
};

}  // namespace chiaro
