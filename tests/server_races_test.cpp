// The viewer's server while much happens at once: watched by the thread sanitizer (scripts/races), and held to the
// pictures of a session that nothing disturbed.
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>

#include "races.h"
#include "server/frame_sender.h"
#include "server/render_worker.h"
#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr Method quick_methods[] = {Method::none, Method::spao, Method::visibility, Method::histogram,
                                    Method::reference};
constexpr const char* quick_names[] = {"none", "spao", "visibility", "histogram", "reference"};

std::string png_of(const Scene& scene) {
    Progress progress;
    const auto bytes = encode_png(render_image(Device::cpu(2), scene, progress));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What a worker sends: all is taken in, and the last picture kept.
class Album {
public:
    server::RenderWorker::FrameCallbacks callbacks() {
        return {[this](int, std::string frame) { take(frame); },
                [this](int, const Json& message) {
                    const std::lock_guard lock(mutex_);
                    if (message["type"] == "error") errors_ += message.dump() + "\n";
                },
                [this] {
                    return asked_++ % 2 ? server::LinkState{6e5, 0.05, 0.002} : server::LinkState();
                }};
    }
    /// The final picture of state n.
    std::string wait_for(std::int64_t n) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return finals_.contains(n) || !errors_.empty(); });
        EXPECT_EQ(errors_, "");
        return finals_[n];
    }

private:
    void take(const std::string& frame) {
        std::uint32_t length = 0;
        for (int i = 7; i >= 4; --i) length = length << 8 | std::uint8_t(frame[std::size_t(i)]);
        const Json header = Json::parse(frame.substr(8, length));
        if (header["stage"] != "final") return;
        const std::lock_guard lock(mutex_);
        finals_[header["n"].get<std::int64_t>()] = frame.substr(8 + length);
        changed_.notify_all();
    }

    std::atomic<int> asked_{0};  // for the way, which changes all the time
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::int64_t, std::string> finals_;
    std::string errors_;
};

server::FrameRequest request_of(std::int64_t n, const Scene& scene, Chance& chance) {
    server::FrameRequest request;
    request.n = n, request.scene = scene;
    request.moving = chance.pick(0, 2) == 0, request.preview = chance.pick(0, 5) == 0;
    return request;
}

/// One thing that a page may ask for while its picture is drawn.
Json request_of(const Json& scene, Chance& chance) {
    switch (chance.pick(0, 9)) {
        case 0:
            return {{"type", "pick"}, {"x", chance.pick(0, 20)}, {"y", chance.pick(0, 15)}};
        case 1:
            return {{"type", "look"}, {"scene", scene}, {"size", {16, 12}}};
        case 2:
            return {{"type", "compare"}, {"scene", scene}, {"size", {12, 9}}, {"method", "spao"}};
        case 3:
            return {{"type", "measure"}, {"scene", scene}, {"size", {12, 9}}};
        case 4:
            return {{"type", "save"}, {"scene", scene}, {"size", {20, 15}}};
        case 5:
            return {{"type", "open"}, {"volume", chance.pick(0, 1) ? "sample:shells:16" : "sample:ball:20"}};
        case 6:
            return {{"type", "resolve"}, {"transfer_function", {{"preset", "viridis"}}}};
        case 7:
            return {{"type", "probe"}, {"probe", {{"name", "sky"}}}, {"size", {16, 8}}};
        case 8:
            return {{"type", "export"}, {"what", "scene"}, {"scene", scene}};
        default:
            return {{"type", "folder"}, {"path", ""}};
    }
}

void edit(Json& scene, Chance& chance) {
    scene["camera"]["azimuth_deg"] = chance.real(0, 360);
    if (chance.pick(0, 2) == 0) scene["transfer_function"]["opacity_scale"] = chance.real(0.1, 2);
    if (chance.pick(0, 3) == 0) scene["lighting"] = {{"method", quick_names[chance.pick(0, 4)]}};
    if (scene["lighting"]["method"] == "visibility") scene["lighting"]["directions"] = 40;
    if (scene["lighting"]["method"] == "reference") scene["lighting"]["rays"] = 4;
    if (scene["lighting"]["method"] == "histogram") scene["lighting"]["radius"] = 4, scene["lighting"]["clusters"] = 32;
}

/// A page at work: states and requests in any order, and some of them cancelled. Answers are not waited for. Ids from
/// 1001 on are those of Page::ask.
void work(Page& page, Json& scene, Chance& chance, int steps) {
    for (int i = 1; i <= steps; ++i) {
        if (chance.pick(0, 2)) {
            edit(scene, chance);
            page.send(state(i, scene, 24, 18, chance.pick(0, 1) == 1));
        } else {
            Json request = request_of(scene, chance);
            request["id"] = i;
            page.send(request);
            if (chance.pick(0, 2) == 0) page.send({{"type", "cancel"}, {"id", 2000 + i}, {"re", i}});
        }
        page.next(chance.real(0, 0.02));
    }
}

}  // namespace

namespace {

/// A page that counts what comes, and puts the pictures of each lane together.
class Counting : public server::Socket {
public:
    void send(std::string) override {}
    void send_newest(std::string) override {}
    void close(int, std::string) override {}
    void send_binary(std::string bytes) override {
        const std::lock_guard lock(mutex_);
        total_ += bytes.size();
        if (bytes.substr(0, 4) != "CHFP" || bytes.size() == 16) return;
        std::string& picture = pictures_[std::size_t(bytes[4])];
        if (bytes.compare(12, 4, std::string(4, '\0')) == 0) picture.clear();
        picture += bytes.substr(16);
    }
    std::uint64_t total() const {
        const std::lock_guard lock(mutex_);
        return total_;
    }
    std::string picture(std::size_t lane) const {
        const std::lock_guard lock(mutex_);
        return pictures_[lane];
    }

private:
    mutable std::mutex mutex_;
    std::uint64_t total_ = 0;
    std::string pictures_[3];
};

}  // namespace

TEST(ServerRaces, PicturesArePostedWhileAPageTellsWhatItGot) {
    for (Rounds rounds; rounds.next();) {
        const auto socket = std::make_shared<Counting>();
        std::atomic<int> moved{0};
        server::FrameSender sender([&] { ++moved; });
        sender.attach(socket, true);
        const std::string last(100'000, 'z'), asked(50'000, 'y');
        std::atomic<bool> done{false};
        const auto is_whole = [&] {
            return socket->picture(0) == last && socket->picture(1) == asked && socket->picture(2) == asked;
        };
        {
            const std::jthread page([&] {
                while (!done || !is_whole()) sender.got(socket->total()), std::this_thread::yield();
            });
            const std::jthread other([&] {
                for (int i = 0; i < 20; ++i)
                    sender.post(asked, {i, i % 3, i % 2 == 0}), sender.tell("answer", i), (void)sender.link();
            });
            Chance chance(rounds.seed());
            for (int i = 0; i < 20; ++i) {
                sender.post_newest(std::string(std::size_t(chance.pick(1, 60'000)), 'a'));
                chance.wait(2);
            }
            sender.post_newest(last);
            done = true;
        }
        EXPECT_TRUE(is_whole());
        EXPECT_GT(moved, 0);
    }
}

TEST(ServerRaces, RequestsArriveWhileAFrameIsDrawn) {
    for (Rounds rounds; rounds.next();) {
        server::Volumes volumes(Device::cpu(2));
        Progress progress;
        const auto ball = volumes.load(small_scene(Method::none), progress);
        Album album;
        server::RenderWorker worker(album.callbacks());
        worker.show(ball);
        std::atomic<std::int64_t> n{0};
        const auto hand = [&](std::uint32_t seed) {
            Chance chance(seed);
            for (int i = 0; i < 15; ++i) {
                Scene scene = small_scene(quick_methods[chance.pick(0, 4)]);
                chiaro::testing::edit(scene, chance);
                worker.request(request_of(++n, scene, chance));
                if (const auto last = worker.last_frame()) EXPECT_LE(last->n, n);
                worker.look_at_link();
                chance.wait(20);
            }
        };
        {
            const std::jthread other(hand, 2 * rounds.seed());
            const std::jthread opener([&] {
                Chance chance(rounds.seed());
                for (int i = 0; i < 5; ++i) {
                    Progress reading;
                    Scene shells = small_scene(Method::none);
                    shells.volume = "sample:shells:16";
                    worker.show(chance.pick(0, 2) ? volumes.load(i % 2 ? shells : ball->source, reading) : nullptr);
                    chance.wait(60);
                }
            });
            hand(2 * rounds.seed() + 1);
        }
        worker.show(ball);
        Chance chance(rounds.seed());
        Scene scene = small_scene(quick_methods[chance.pick(0, 4)]);
        chiaro::testing::edit(scene, chance);
        server::FrameRequest last;
        last.n = ++n, last.scene = scene;
        worker.request(last);
        EXPECT_TRUE(album.wait_for(last.n) == png_of(scene)) << to_text(scene.illumination.method);
    }
}

TEST(ServerRaces, ARenderWorkerEndsWhateverItDoes) {
    for (Rounds rounds; rounds.next();) {
        server::Volumes volumes(Device::cpu(2));
        Progress progress;
        const auto ball = volumes.load(small_scene(Method::none), progress);
        for (std::uint32_t i = 0; i < 6; ++i) {
            Chance chance(6 * rounds.seed() + i);
            Album album;
            server::RenderWorker worker(album.callbacks());
            worker.show(ball);
            const Scene scene = small_scene(i == 5 ? Method::transport : quick_methods[i]);
            worker.request(request_of(1, scene, chance));
            chance.wait(60);
        }
    }
}

TEST(ServerRaces, VolumesAreReadOnceThoughManyAskAndSomeGiveUp) {
    for (Rounds rounds; rounds.next();) {
        server::Volumes volumes(Device::cpu(2));
        const Scene scene = small_scene(Method::none);
        std::mutex mutex;
        std::map<const server::Loaded*, std::shared_ptr<const server::Loaded>> found;
        std::vector<std::jthread> readers;
        for (std::uint32_t i = 0; i < 6; ++i)
            readers.emplace_back([&, i] {
                int reports = 0;
                Progress progress([&](std::string_view, double) { ++reports; });
                const std::jthread canceller([&] {
                    if (i % 3) return;
                    Chance(rounds.seed() + i).wait(10);
                    progress.cancel();
                });
                try {
                    const auto loaded = volumes.load(scene, progress);
                    const std::lock_guard lock(mutex);
                    found.emplace(loaded.get(), loaded);
                } catch (const Error& error) {
                    EXPECT_EQ(error.code(), ErrorCode::interrupted) << error.what();
                }
            });
        readers.clear();
        EXPECT_EQ(found.size(), 1u);
        EXPECT_EQ(volumes.find(scene).get(), found.begin()->first);
    }
}

TEST(ServerRaces, PagesEditWhileTheyAskForOtherThings) {
    for (Rounds rounds; rounds.next();) {
        const Server server("sample:ball:20");
        const auto visit = [&](const std::string& view, std::uint32_t seed) {
            Chance chance(seed);
            Json scene;
            Page page = server.ready(scene, view);
            work(page, scene, chance, 25);
            const Json opened = page.ask({{"type", "open"}, {"volume", "sample:ball:20"}}, 300);
            ASSERT_EQ(opened["type"], "answer") << opened;
            scene = opened["scene"];
            edit(scene, chance);
            page.send(state(1000, scene, 24, 18));
            const auto last = page.of_stage(1000, "final", 300);
            ASSERT_TRUE(last);
            std::vector<std::string> unknown;
            Scene same = parse_scene(scene.dump(), {}, {}, unknown);
            same.volume = "sample:ball:20", same.width = 24, same.height = 18;
            EXPECT_TRUE(last->image == png_of(same)) << scene;
        };
        const std::jthread other(visit, "view-of-another", 2 * rounds.seed());
        visit("view-of-one", 2 * rounds.seed() + 1);
    }
}

TEST(ServerRaces, TheServerEndsWhateverItDoes) {
    for (Rounds rounds; rounds.next();) {
        Chance chance(rounds.seed());
        std::optional<Server> server(std::in_place, "sample:ball:20");
        Json scene;
        Page page = server->ready(scene), taker = server->page("view-one", "&take=1");
        Page leaver = server->page("view-two");
        work(taker, scene, chance, 10);
        if (chance.pick(0, 1)) Page(std::move(leaver));
        taker.send({{"type", "compare"}, {"id", 5000}, {"scene", scene}, {"size", {200, 150}}});
        taker.send({{"type", "open"}, {"id", 5001}, {"volume", "sample:shells:24"}});
        chance.wait(100);
        std::jthread reader([&] { taker.closed(60); });  // a page answers a close
        server.reset();
    }
}
