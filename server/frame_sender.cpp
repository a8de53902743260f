#include "frame_sender.h"

namespace chiaro::server {
namespace {

/// A part of a picture: "CHFP", then as uint32, little endian, its lane (0: pictures that replace each other, 1: all
/// others), the bytes of the whole and where this part begins; a mark is a part of nothing.
std::string part_message(std::uint32_t lane, std::size_t whole, std::size_t begin, std::string_view bytes) {
    std::string message = "CHFP";
    for (const std::uint32_t number : {lane, std::uint32_t(whole), std::uint32_t(begin)})
        for (int shift = 0; shift < 32; shift += 8) message += char(number >> shift & 255);
    return message.append(bytes);
}

}  // namespace

void FrameSender::attach(std::shared_ptr<Socket> socket, bool paced) {
    const std::lock_guard lock(mutex_);
    socket_ = std::move(socket);
    paced_ = paced;
    pace_ = LinkPace();
    newest_.clear(), others_.clear();
}

void FrameSender::detach() { attach(nullptr, false); }

void FrameSender::post_newest(std::string frame) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (!paced_) return socket_->send_newest(std::move(frame));
    newest_.clear();
    newest_.push_back({std::move(frame)});
    pump();
}

void FrameSender::post(std::string frame) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (!paced_) return socket_->send_binary(std::move(frame));
    others_.push_back({std::move(frame)});
    pump();
}

void FrameSender::tell(std::string text) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (others_.empty()) return socket_->send(std::move(text));
    others_.push_back({std::move(text), true});
}

void FrameSender::got(std::uint64_t bytes) {
    {
        const std::lock_guard lock(mutex_);
        if (!paced_) return;
        pace_.got(bytes, std::chrono::steady_clock::now());
        pump();
    }
    moved_();
}

LinkState FrameSender::link() const {
    const std::lock_guard lock(mutex_);
    return paced_ ? pace_.state(std::chrono::steady_clock::now()) : LinkState();
}

/// What was asked for goes before what comes by itself.
void FrameSender::pump() {
    bool begun = false;
    for (;;) {
        for (; !others_.empty() && others_.front().is_text; others_.pop_front())
            socket_->send(std::move(others_.front().bytes));
        if (pace_.room() == 0 || (newest_.empty() && others_.empty())) return;
        if (!begun) {
            const std::string mark = part_message(0, 0, 0, "");
            pace_.sent_mark(mark.size(), std::chrono::steady_clock::now());
            socket_->send_binary(mark);
            begun = true;
        }
        const std::uint32_t lane = others_.empty() ? 0 : 1;
        std::deque<Waiting>& queue = lane ? others_ : newest_;
        Waiting& first = queue.front();
        const std::string_view bytes = std::string_view(first.bytes).substr(first.sent, pace_.part());
        std::string part = part_message(lane, first.bytes.size(), first.sent, bytes);
        first.sent += bytes.size();
        if (first.sent == first.bytes.size()) queue.pop_front();
        pace_.sent(part.size(), std::chrono::steady_clock::now());
        socket_->send_binary(std::move(part));
    }
}

}  // namespace chiaro::server
