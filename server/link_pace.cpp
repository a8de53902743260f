#include "link_pace.h"

#include <algorithm>
#include <vector>

namespace chiaro::server {
namespace {

using Seconds = std::chrono::duration<double>;

// Tuned by scripts/far_away: 50 ms and 5 Mbit/s, 150 ms and 2 Mbit/s, each with and without jitter of 20 ms.
constexpr std::size_t last_bursts = 12, worth_a_sample = 4096;
constexpr double near_round_trip = 0.005;  // seconds: what is nearer is as quick as the page, which may be busy
constexpr auto remembered = std::chrono::seconds(10);  // of round trips
constexpr double jitter = 0.03;                  // seconds: what lies further from the shortest round trip is a queue
constexpr double queued = 0.15, of_part = 0.05;  // seconds
constexpr std::size_t least_room = 32 << 10, unknown_room = 64 << 10, least_part = 8 << 10, largest_part = 256 << 10;

double middle(std::vector<double> values) {
    const auto at = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

void LinkPace::sent_mark(std::size_t bytes, Time now) {
    ++burst_;
    add(bytes, now, true);
}

void LinkPace::sent(std::size_t bytes, Time now) { add(bytes, now, false); }

void LinkPace::add(std::size_t bytes, Time now, bool is_mark) {
    sent_ += bytes;
    messages_.push_back({sent_, now, burst_, is_mark, free_at_ <= now});
    free_at_ = std::max(free_at_, now);
    if (rate_ > 0) free_at_ += std::chrono::duration_cast<Time::duration>(Seconds(double(bytes) / rate_));
}

void LinkPace::got(std::uint64_t total, Time now) {
    if (total <= got_ || total > sent_) return;  // nothing new, or nothing that was sent
    got_ = total;
    while (!messages_.empty() && messages_.front().end <= total) {
        const Message message = messages_.front();
        messages_.pop_front();
        answered(message, messages_.empty() || messages_.front().burst != message.burst, now);
    }
    if (rate_ > 0)
        free_at_ =
            now + std::chrono::duration_cast<Time::duration>(Seconds(double(sent_ - got_) / rate_ - round_trip_));
}

void LinkPace::answered(const Message& message, bool ends_burst, Time now) {
    if (message.is_mark) {
        marked_burst_ = message.burst, mark_answered_ = now, mark_end_ = message.end;
        if (message.is_clear) learn_round_trip(Seconds(now - message.at).count(), now);
        return;
    }
    if (!ends_burst || message.burst != marked_burst_ || message.end - mark_end_ < worth_a_sample) return;
    bursts_.emplace_back(double(message.end - mark_end_), Seconds(now - mark_answered_).count());
    if (bursts_.size() > last_bursts) bursts_.pop_front();
    double bytes = 0, seconds = 0;
    for (const auto& [of_burst, took] : bursts_) bytes += of_burst, seconds += took;
    rate_ = bytes / std::max(1e-4, seconds);
}

void LinkPace::learn_round_trip(double seconds, Time now) {
    round_trips_.emplace_back(now, seconds);
    while (round_trips_.front().first < now - remembered) round_trips_.pop_front();
    std::vector<double> values;
    for (const auto& [at, value] : round_trips_) values.push_back(value);
    const double shortest = *std::min_element(values.begin(), values.end());
    round_trip_ = std::min(middle(std::move(values)), shortest + jitter);
}

std::size_t LinkPace::room() const {
    const std::size_t most =
        rate_ > 0 ? std::max(least_room, std::size_t(rate_ * (round_trip_ + queued))) : unknown_room;
    const auto under_way = std::size_t(sent_ - got_);
    return under_way < most ? most - under_way : 0;
}

std::size_t LinkPace::part() const {
    return rate_ > 0 ? std::clamp(std::size_t(rate_ * of_part), least_part, largest_part) : 2 * least_part;
}

LinkState LinkPace::state(Time now) const {
    LinkState state;
    if (round_trip_ < near_round_trip) return state;
    if (rate_ > 0) state.bytes_per_second = rate_;
    state.round_trip = round_trip_;
    state.free_in = std::max(0.0, Seconds(free_at_ - now).count());
    return state;
}

}  // namespace chiaro::server
