// Between a decoder and the program that fetches: what the cache holds is not fetched again.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "io/helper_process.h"
#include "io/http_cache.h"

namespace chiaro {

/// Answers one decoder, in a thread of its own, until either end is gone.
class HttpRelay {
public:
    /// `url`: below which the decoder asks.
    HttpRelay(std::shared_ptr<HttpCache> cache, std::string url, Descriptor decoder, Descriptor fetcher);
    HttpRelay(const HttpRelay&) = delete;
    HttpRelay& operator=(const HttpRelay&) = delete;
    ~HttpRelay();

    bool has_ended() const { return has_ended_; }

private:
    void run();
    bool answer(const std::string& request);
    bool forward(const std::string& what, std::string_view part);

    /// One end of a connection; what fails there ends the relay.
    class End;
    const std::shared_ptr<HttpCache> cache_;
    const std::string url_;
    std::unique_ptr<End> decoder_, fetcher_;
    std::atomic<bool> has_ended_{false};
    std::thread thread_;
};

}  // namespace chiaro
