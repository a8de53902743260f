#include "frame_sender.h"

#include <utility>

namespace chiaro::server {
namespace {

/// A part of a picture: "CHFP", then as uint32, little endian, its lane (0: pictures that replace each other, 1: those
/// that were asked for, 2: drafts of them), the bytes of the whole and where this part begins; a mark is a part of
/// nothing.
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
    for (Queue& queue : queues_) queue.clear();
}

void FrameSender::detach() { attach(nullptr, false); }

void FrameSender::post_newest(std::string frame) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (!paced_) return socket_->send_newest(std::move(frame));
    queues_[newest].clear();
    queues_[newest].push_back({std::move(frame)});
    pump();
}

void FrameSender::post(std::string frame, const PictureKind& kind) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (!paced_) return socket_->send_binary(std::move(frame));
    end_replaced(queues_[others], kind);
    if (kind.is_draft) end_replaced(queues_[drafts], kind);
    queues_[kind.is_draft ? drafts : others].push_back({std::move(frame), kind});
    pump();
}

void FrameSender::end_replaced(Queue& queue, const PictureKind& by) {
    const auto is_replaced = [&](const Waiting& old) {
        const bool may_end = !old.kind.is_draft || old.sent == 0;
        if (!by.pane || old.kind.pane != by.pane || !may_end) return false;
        say_all(old.then);
        return true;
    };
    std::erase_if(queue, is_replaced);
}

void FrameSender::tell(std::string text, std::optional<std::int64_t> request) {
    const std::lock_guard lock(mutex_);
    if (!socket_) return;
    if (request)
        for (Queue& queue : queues_)
            for (auto waiting = queue.rbegin(); waiting != queue.rend(); ++waiting)
                if (waiting->kind.request == request) return waiting->then.push_back(std::move(text));
    socket_->send(std::move(text));
}

void FrameSender::say_all(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) socket_->send(text);
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

/// What was asked for goes before what comes by itself, drafts before both.
FrameSender::Lane FrameSender::next_lane() const {
    return !queues_[drafts].empty() ? drafts : !queues_[others].empty() ? others : newest;
}

void FrameSender::pump() {
    bool begun = false;
    for (;;) {
        const Lane lane = next_lane();
        Queue& queue = queues_[lane];
        if (pace_.room() == 0 || queue.empty()) return;
        if (!std::exchange(begun, true)) {
            const std::string mark = part_message(0, 0, 0, "");
            pace_.sent_mark(mark.size(), std::chrono::steady_clock::now());
            socket_->send_binary(mark);
        }
        Waiting& first = queue.front();
        const std::string_view bytes = std::string_view(first.bytes).substr(first.sent, pace_.part());
        std::string part = part_message(lane, first.bytes.size(), first.sent, bytes);
        first.sent += bytes.size();
        pace_.sent(part.size(), std::chrono::steady_clock::now());
        socket_->send_binary(std::move(part));
        if (first.sent < first.bytes.size()) continue;
        say_all(first.then);
        queue.pop_front();
    }
}

}  // namespace chiaro::server
