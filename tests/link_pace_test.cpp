// What goes onto a slow way to a page, by a simulated one: no clock, the same each time.
#include "server/link_pace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <random>

#include "server/adaptive_resolution.h"
#include "server/frame_sender.h"

using namespace chiaro::server;

namespace {

using Time = LinkPace::Time;
using Seconds = std::chrono::duration<double>;

Time at(double seconds) { return Time() + std::chrono::duration_cast<Time::duration>(Seconds(seconds)); }

/// A way of a rate and a round trip: messages go through its narrow part one after the other, the answers come back.
struct Way {
    double bytes_per_second, round_trip, jitter = 0;
    std::mt19937 random{7};
    double free = 0, answered = 0, longest = 0;
    struct Answer {
        double at;
        std::uint64_t total;
    };
    std::deque<Answer> answers{};
    std::uint64_t total = 0;

    void send(std::size_t bytes, double now) {
        free = std::max(free, now) + double(bytes) / bytes_per_second;
        longest = std::max(longest, free - now);
        const double late = jitter * std::uniform_real_distribution<double>(-1, 1)(random);
        answered = std::max(answered, free + round_trip + late);
        answers.push_back({answered, total += bytes});
    }
};

struct Seen {
    int drafts = 0;
    double age = 0;  ///< the oldest, sent to answered, without the first second
    double rate = 0, bytes = 0;
};

/// Drafts of the size that fits, each as soon as the way is thought to be free when it is drawn (30 ms).
Seen drag(
    LinkPace& pace, Way& way, double from, double to, const std::function<void(double)>& each = [](double) {}) {
    Seen seen;
    for (double now = from; now < to; now += 0.001) {
        each(now);
        for (; !way.answers.empty() && way.answers.front().at <= now; way.answers.pop_front())
            pace.got(way.answers.front().total, at(way.answers.front().at));
        const LinkState link = pace.state(at(now));
        if (link.free_in > 0.03 || pace.room() == 0) continue;
        const auto bytes = std::size_t(std::min(20000.0, link.draft_bytes()));
        const double drawn = now + 0.03;
        pace.sent_mark(16, at(drawn)), way.send(16, drawn);
        pace.sent(bytes, at(drawn)), way.send(bytes, drawn);
        if (now > from + 1) seen.age = std::max(seen.age, way.answered - now);
        ++seen.drafts, now = drawn;
        seen.rate = link.bytes_per_second, seen.bytes = double(bytes);
    }
    return seen;
}

}  // namespace

TEST(LinkPace, FindsTheRateAndKeepsDraftsYoung) {
    for (const double jitter : {0.0, 0.02})
        for (const auto& [rate, round_trip, count, age] :
             {std::tuple{625000.0, 0.05, 15, 0.15}, std::tuple{250000.0, 0.15, 8, 0.35}}) {
            LinkPace pace;
            Way way{rate, round_trip, jitter};
            const Seen seen = drag(pace, way, 0, 10);
            EXPECT_GE(seen.drafts, 10 * count) << rate << " " << jitter;
            EXPECT_LE(seen.age, age + 2 * jitter) << rate << " " << jitter;
            EXPECT_GT(seen.rate, (jitter > 0 ? 0.6 : 0.95) * rate);
            EXPECT_LT(seen.rate, (jitter > 0 ? 2 : 1.05) * rate);  // answers that are held up come together
            EXPECT_GT(seen.bytes, jitter > 0 ? 3500 : 6000);
        }
}

TEST(LinkPace, AWayThatBecomesHalfAsQuickIsFollowed) {
    LinkPace pace;
    Way way{625000, 0.05};
    drag(pace, way, 0, 5);
    way.bytes_per_second /= 2;
    way.longest = 0;
    drag(pace, way, 5, 7);
    EXPECT_LT(way.longest, 0.5);
    way.longest = 0;
    const Seen after = drag(pace, way, 7, 12);
    EXPECT_LT(way.longest, 0.15) << "steady after two seconds";
    EXPECT_NEAR(after.rate, 312500, 30000);
    // One that is quick again, too.
    way.bytes_per_second *= 8;
    drag(pace, way, 12, 14);
    EXPECT_NEAR(pace.state(at(14)).bytes_per_second, 2500000, 300000);
}

TEST(LinkPace, NeverMoreIsUnderWayThanTheWayTakesInASecond) {
    for (const double rate : {250000.0, 625000.0}) {
        LinkPace pace;
        Way way{rate, 0.15};
        // A picture of ten million bytes, part by part, as fast as there is room.
        double now = 0;
        for (std::size_t left = 10'000'000; left > 0; now += 0.001) {
            if (now > 3) way.bytes_per_second = rate / 2;
            for (; !way.answers.empty() && way.answers.front().at <= now; way.answers.pop_front())
                pace.got(way.answers.front().total, at(way.answers.front().at));
            for (bool begun = false; left > 0 && pace.room() > 0; begun = true) {
                if (!begun) pace.sent_mark(16, at(now)), way.send(16, now);
                const std::size_t part = std::min(left, pace.part());
                pace.sent(part, at(now)), way.send(part, now);
                left -= part;
            }
        }
        EXPECT_LT(way.longest, 1) << rate;
        EXPECT_LT(now, 1.1 * (3 + (10e6 - 3 * rate) / (rate / 2))) << "and the way is never idle";
    }
}

TEST(LinkPace, AnswersThatAreNoneChangeNothing) {
    LinkPace pace;
    pace.sent_mark(16, at(0));
    pace.sent(1000, at(0));
    const std::size_t room = pace.room();
    pace.got(5000, at(1));  // more than was sent
    pace.got(0, at(1));
    EXPECT_EQ(pace.room(), room);
    pace.got(1016, at(1));
    EXPECT_EQ(pace.room(), room + 1016);
    pace.got(1016, at(2));
    EXPECT_EQ(pace.room(), room + 1016);
}

TEST(AdaptiveResolution, ASlowWayLowersSizeAndQualityButNotBelow640Or480) {
    AdaptiveResolution resolution;
    resolution.learn({1, 1, 70}, 1e-9);
    LinkState quick, slow;
    for (int i = 0; i < 4; ++i) resolution.size(1000, 800, quick);
    EXPECT_EQ(resolution.size(1000, 800, quick).width, 1000);
    resolution.learn_bytes({1000, 800, 70}, 80000);
    slow.bytes_per_second = 625000, slow.round_trip = 0.05;
    EXPECT_EQ(resolution.size(1000, 800, quick).quality, 70);
    DraftSize draft = resolution.size(1000, 800, slow);  // 9375 bytes fit
    EXPECT_EQ(draft.width, 640);
    EXPECT_LT(draft.quality, 70);
    slow.bytes_per_second = 1000;
    draft = resolution.size(1000, 800, slow);
    EXPECT_EQ(draft.width, 480);
    EXPECT_EQ(draft.quality, 25);
    // A scene that takes its time is not drawn smaller for that alone.
    slow.bytes_per_second = 625000;
    resolution.learn({1000, 800, 70}, 0.15);
    for (int i = 0; i < 4; ++i) draft = resolution.size(1000, 800, slow);
    EXPECT_EQ(draft.width, 640);
}

TEST(AdaptiveResolution, ASlowSceneIsDrawnWithFewerSamplesBeforeItIsDrawnSmaller) {
    const auto drawn = [](double seconds_of_the_whole) {
        AdaptiveResolution resolution;
        resolution.learn({1000, 800, 70}, seconds_of_the_whole);
        const DraftSize draft = resolution.size(1000, 800, {});
        return std::pair(draft.width, draft.step_factor);
    };
    EXPECT_EQ(drawn(0.02), std::pair(1000, 1.0));
    EXPECT_EQ(drawn(0.04), std::pair(707, 1.0));
    EXPECT_EQ(drawn(0.07), std::pair(707, 2.0));
    EXPECT_EQ(drawn(0.2), std::pair(500, 2.0));
    EXPECT_EQ(drawn(0.4), std::pair(354, 2.0));
    EXPECT_EQ(drawn(0.7), std::pair(354, 4.0));
    EXPECT_EQ(drawn(10), std::pair(250, 4.0));
}

namespace {

struct Kept : Socket {
    void send(std::string text) override { said.push_back(std::move(text)); }
    void send_binary(std::string bytes) override { said.push_back(std::move(bytes)); }
    void send_newest(std::string) override { FAIL(); }
    void close(int, std::string) override {}
    std::vector<std::string> said;
};

std::uint32_t number(const std::string& message, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(message[at + i]);
    return value;
}

}  // namespace

namespace {

/// A sender to a page that says what it got only when told to.
struct Page {
    std::shared_ptr<Kept> socket = std::make_shared<Kept>();
    FrameSender sender{[] {}};

    Page() { sender.attach(socket, true); }
    std::uint64_t bytes() const {
        std::uint64_t sum = 0;
        for (const std::string& message : socket->said)
            if (message.starts_with("CHFP")) sum += message.size();
        return sum;
    }
    void take_all() {
        for (std::size_t i = 0; i < 200; ++i) sender.got(bytes());
    }
    /// What came, in its order: what is said, and of each picture, once it is whole, its first letter.
    std::string whole() const {
        std::string seen, lanes[3];
        for (const std::string& message : socket->said) {
            if (!message.starts_with("CHFP")) {
                seen += message;
                continue;
            }
            if (number(message, 8) == 0) continue;  // a mark
            std::string& lane = lanes[number(message, 4)];
            if (number(message, 12) == 0) lane.clear();
            EXPECT_EQ(number(message, 12), lane.size()) << "in their order, none left out";
            lane += message.substr(16);
            if (lane.size() == number(message, 8)) seen += lane[0];
        }
        return seen;
    }
};

PictureKind draft(std::int64_t request, int pane) { return {request, pane, true}; }
PictureKind lossless(std::int64_t request, int pane) { return {request, pane, false}; }

}  // namespace

TEST(FrameSender, PartsComeInOrderAndANewerPictureEndsAnOlder) {
    Page page;
    page.sender.post_newest(std::string(1 << 20, 'a'));
    const std::size_t before = page.socket->said.size();
    EXPECT_LT(page.bytes(), 100'000u) << "no more than there is room for";
    // What was asked for goes before the rest of it, and what is said about it after that.
    page.sender.post(std::string(100, 'b'), {7, {}, false});
    page.sender.tell("!", 7);
    EXPECT_EQ(page.socket->said.size(), before);
    page.sender.tell("?", 8);
    EXPECT_EQ(page.socket->said.back(), "?") << "what is said of something else need not wait";
    page.sender.post_newest(std::string(100'000, 'c'));
    page.take_all();
    EXPECT_EQ(page.whole(), "?b!c");
}

TEST(FrameSender, ADraftOvertakesLosslessPicturesThatAreHalfSent) {
    Page page;
    // Three panes at rest, then a step in the second.
    for (int pane = 0; pane < 3; ++pane) {
        page.sender.post(std::string(200'000, char('A' + pane)), lossless(pane, pane));
        page.sender.tell(std::string(1, char('0' + pane)), pane);
    }
    ASSERT_EQ(page.whole(), "") << "the first is half sent";
    page.sender.post(std::string(20'000, 'd'), draft(3, 1));
    page.sender.tell("3", 3);
    page.take_all();
    // The second's lossless one is over, and its request answered; the others go on where they were.
    EXPECT_EQ(page.whole(), "1d3A0C2");
}

TEST(FrameSender, ALosslessPictureThatIsHalfSentEndsWhereItsPaneMovedOn) {
    Page page;
    page.sender.post(std::string(200'000, 'A'), lossless(0, 0));
    page.sender.tell("0", 0);
    page.sender.post(std::string(300'000, 'B'), lossless(1, 0));
    page.sender.tell("1", 1);
    page.sender.post(std::string(300'000, 'C'), {2, {}, false});
    page.take_all();
    EXPECT_EQ(page.whole(), "0B1C");
}

TEST(FrameSender, DraftsThatComeFasterThanTheWayIsAreStillShown) {
    Page page;
    for (int i = 0; i < 26; ++i) {
        page.sender.post(std::string(40'000, char('a' + i)), draft(i, 0));
        page.sender.tell(".", i);
    }
    page.sender.post(std::string(100'000, '#'), lossless(99, 0));
    page.take_all();
    // One that is begun is not given up; those that wait are, and answered; the lossless one waits for the last.
    EXPECT_EQ(page.whole(), "a." + std::string(23, '.') + "b.z.#");
}
