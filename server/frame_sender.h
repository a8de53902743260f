// Pictures on their way to a page: in parts, as many as the way has room for, drafts before what may wait, and of
// pictures that replace each other the newest alone.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "link_pace.h"
#include "net.h"

namespace chiaro::server {

/// What a picture that was asked for is about.
struct PictureKind {
    std::optional<std::int64_t> request;  ///< its id
    std::optional<int> pane;              ///< where the page shows it: the next one there takes its place
    bool is_draft = false;                ///< quick and small: it overtakes all but drafts, half sent or not
};

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
    /// A picture that was asked for. It ends what waits for its pane: a lossless one even half sent, a draft only where
    /// nothing of it is sent, else pages that ask faster than the way is would never have a whole one; and a draft
    /// never for a lossless one, which comes later.
    void post(std::string frame, const PictureKind& kind);
    /// What is said: after the pictures posted for that request, where there is one.
    void tell(std::string text, std::optional<std::int64_t> request = {});
    /// The page has so many bytes of pictures in all.
    void got(std::uint64_t bytes);
    LinkState link() const;

private:
    struct Waiting {
        std::string bytes;
        PictureKind kind{};
        std::size_t sent = 0;
        std::vector<std::string> then{};  ///< what is said after it
    };
    using Queue = std::deque<Waiting>;
    enum Lane { newest, others, drafts };
    // While locked:
    void pump();
    void end_replaced(Queue& queue, const PictureKind& by);
    void say_all(const std::vector<std::string>& texts);
    Lane next_lane() const;

    std::function<void()> moved_;
    mutable std::mutex mutex_;
    std::shared_ptr<Socket> socket_;
    bool paced_ = false;
    LinkPace pace_;
    std::array<Queue, 3> queues_;  ///< by lane; of the newest at most one
};

}  // namespace chiaro::server
