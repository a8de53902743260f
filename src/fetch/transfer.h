// One file, or a part of one, from its server: redirects, second tries, and all that an answer must be.
#pragma once
#include <curl/curl.h>

#include <chrono>
#include <optional>
#include <string>

#include "fetch/server.h"

namespace chiaro::fetch {

using Clock = std::chrono::steady_clock;

class Transfer {
public:
    Transfer(CURLM* multi, const Server& server, Request request);
    Transfer(const Transfer&) = delete;
    Transfer& operator=(const Transfer&) = delete;
    ~Transfer();

    /// What curl says of the try that has ended.
    void end(CURLcode result);
    /// Begins the next try once its time has come.
    void wake();
    /// What io/wire.h says, with the line's end; empty: not yet.
    const std::string& answer() const { return answer_; }
    const Request& request() const { return request_; }
    const std::string& body() const { return body_; }    ///< of a part
    const std::string& tag() const { return got_.tag; }  ///< the server's ETag
    std::size_t received() const { return body_.size(); }

private:
    struct Headers {
        std::string range, encoding, tag;
        double retry_after = 0;
        std::size_t bytes = 0;
    };
    static std::size_t take_body(char* bytes, std::size_t one, std::size_t count, void* self);
    static std::size_t take_header(char* bytes, std::size_t one, std::size_t count, void* self);
    static curl_socket_t open_socket(void* self, curlsocktype purpose, curl_sockaddr* address);

    void begin();
    void fault(const std::string& sentence);
    void redirect();
    void try_again(const std::string& sentence);
    void take_answer(long status);
    void take_part();
    bool is_known(const std::string& tag);
    bool is_at_home() const;

    CURLM* multi_;
    CURL* easy_;
    curl_slist* headers_ = nullptr;
    const Server& server_;
    Request request_;
    std::string url_, answer_, body_;
    std::string refusal_;  ///< why curl was told to stop
    Headers got_;
    int redirects_ = 0, tries_ = 0;
    bool is_running_ = false;
    Clock::time_point start_ = Clock::now(), next_try_ = start_;
};

}  // namespace chiaro::fetch
