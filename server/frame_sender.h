// Pictures on their way to a page: in parts, as many as the way has room for, and of pictures that replace each other
// the newest alone.
#pragma once
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "link_pace.h"
#include "net.h"

namespace chiaro::server {

/// Every call may come from any thread.
class FrameSender {
public:
    /// `moved` is called, outside of every lock, when the page got something: there may be room.
    explicit FrameSender(std::function<void()> moved) : moved_(std::move(moved)) {}

    /// To this page from now on; what waited for another is gone. A page that is not `paced` says nothing of what it
    /// got: it is sent all at once.
    void attach(std::shared_ptr<Socket> socket, bool paced);
    void detach();
    /// A picture that takes the place of every one posted so before, the rest of one that is half sent too.
    void post_newest(std::string frame);
    void post(std::string frame);
    /// What is said: after the pictures posted before, which it may be the answer about.
    void tell(std::string text);
    /// The page has so many bytes of pictures in all.
    void got(std::uint64_t bytes);
    LinkState link() const;

private:
    struct Waiting {
        std::string bytes;
        bool is_text = false;
        std::size_t sent = 0;
    };
    void pump();  ///< while locked

    std::function<void()> moved_;
    mutable std::mutex mutex_;
    std::shared_ptr<Socket> socket_;
    bool paced_ = false;
    LinkPace pace_;
    std::deque<Waiting> newest_, others_;  ///< of the newest at most one
};

}  // namespace chiaro::server
