// How quick the way to a page is, by what the page says it got; and so how much may be sent, and when.
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

namespace chiaro::server {

/// What a picture that is to be sent should know of the way; of a short one, and one that nobody measures: that it is
/// quick.
struct LinkState {
    double bytes_per_second = 1e12;
    double round_trip = 0;  ///< seconds, of a message that waits for no other
    double free_in = 0;     ///< seconds until the narrowest part has let through what was sent

    /// Of a picture while something moves: what goes through in 10 ms and a tenth of the round trip.
    double draft_bytes() const { return bytes_per_second * (0.01 + 0.1 * round_trip); }
    /// Below 10 Mbit/s pictures are felt to take time.
    bool is_slow() const { return bytes_per_second < 1.25e6; }
};

/// Messages go out in bursts, each begun by a mark of a few bytes. The time from the answer to a mark to the answer to
/// what was sent right behind it is what that took on the narrowest part of the way, wherever that lies and however
/// long the way is: the last bursts together tell the rate. Answers to marks before which nothing waited tell the
/// round trip. Times are the caller's.
class LinkPace {
public:
    using Time = std::chrono::steady_clock::time_point;

    void sent_mark(std::size_t bytes, Time now);
    void sent(std::size_t bytes, Time now);
    /// The other side has so many bytes in all.
    void got(std::uint64_t total, Time now);
    /// Bytes that may be sent now: what is under way stays below what goes through in the round trip and 150 ms more,
    /// and below 64 KiB while no rate is known.
    std::size_t room() const;
    /// Large messages are cut into parts of 50 ms of the way, so that others need not wait for them.
    std::size_t part() const;
    LinkState state(Time now) const;

private:
    struct Message {
        std::uint64_t end;  ///< of all bytes, after this one
        Time at;
        int burst;
        bool is_mark, is_clear;  ///< clear: nothing was thought to wait before it
    };
    void add(std::size_t bytes, Time now, bool is_mark);
    void answered(const Message& message, bool ends_burst, Time now);
    void learn_round_trip(double seconds, Time now);

    std::deque<Message> messages_;  ///< that are under way
    std::uint64_t sent_ = 0, got_ = 0, mark_end_ = 0;
    int burst_ = 0, marked_burst_ = -1;
    Time mark_answered_{}, free_at_{};
    std::deque<std::pair<double, double>> bursts_;  ///< the last ones: bytes, seconds
    std::deque<std::pair<Time, double>> round_trips_;
    double rate_ = 0, round_trip_ = 0;  ///< 0: not known
};

}  // namespace chiaro::server
