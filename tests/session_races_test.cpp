// What sessions do at the same time, and beside what: watched by the thread sanitizer (scripts/races), and held to the
// pictures of a session that nothing disturbed.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

#include "races.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int threads = 3;  // of each call; more than some machines have, so that they are interrupted anywhere
constexpr Method all_methods[] = {Method::none,      Method::spao,      Method::visibility,
                                  Method::histogram, Method::transport, Method::reference};

Session new_session() {
    Progress progress;
    Session session(Device::cpu(threads));
    session.show(make_sample("ball", race_edge), progress);
    return session;
}

Image image_of(const Scene& scene) {
    Progress progress;
    Session session = new_session();
    return session.render(scene, progress);
}

/// Light that is refined from the light before ends within its tolerance; all else is the same to the bit.
void expect_same(const Image& a, const Image& b, const Scene& scene, const std::string& where) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size()) << where;
    if (scene.illumination.method != Method::transport) {
        EXPECT_TRUE(a.pixels == b.pixels) << where;
        return;
    }
    double squares = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) squares += std::pow(double(a.pixels[i]) - b.pixels[i], 2);
    EXPECT_LT(std::sqrt(squares / double(a.pixels.size())), 2) << where;
}

/// False where it was cancelled.
bool is_whole(const std::function<void()>& work) {
    try {
        work();
        return true;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted) << error.what();
        return false;
    }
}

/// Renders the newest scene, as a viewer does: a newer one cancels the work for the one before.
class Desk {
public:
    explicit Desk(Session& session) : session_(session), thread_([this] { run(); }) {}
    ~Desk() {
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
            if (under_way_) under_way_->cancel();
        }
        changed_.notify_all();
    }

    void show(const Scene& scene) {
        {
            const std::lock_guard lock(mutex_);
            newest_ = scene;
            if (under_way_) under_way_->cancel();
        }
        changed_.notify_all();
    }
    /// The picture of the last scene.
    Image wait() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !newest_ && !under_way_; });
        return last_;
    }

private:
    void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return ending_ || newest_; });
            if (ending_) return;
            const Scene scene = std::move(*newest_);
            newest_.reset();
            int reports = 0;  // plain, as a user's: reports come one at a time
            Progress progress([&](std::string_view, double) { ++reports; });
            under_way_ = &progress;
            lock.unlock();
            Image image;
            std::size_t seen = 0;
            const auto preview = [&](const Image& coarse) { seen += coarse.pixels.size(); };
            const bool is_done = is_whole([&] {
                session_.preview(scene, progress);
                image = session_.render(scene, progress, preview);
            });
            lock.lock();
            under_way_ = nullptr;
            if (is_done) last_ = std::move(image);
            changed_.notify_all();
        }
    }

    Session& session_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Scene> newest_;
    Progress* under_way_ = nullptr;
    bool ending_ = false;
    Image last_;
    std::jthread thread_;
};

}  // namespace

TEST(SessionRaces, EditsWhileLightIsRefined) {
    for (Rounds rounds; rounds.next();) {
        Chance chance(rounds.seed());
        for (const Method method : all_methods) {
            Session session = new_session();
            Scene scene = small_scene(method);
            Desk desk(session);
            for (int i = 0; i < 8; ++i) {
                edit(scene, chance);
                desk.show(scene);
                chance.wait(15);
            }
            expect_same(desk.wait(), image_of(scene), scene, std::string(to_text(method)));
        }
    }
}

TEST(SessionRaces, EditsFromTwoHandsAndAnEndAtAnyMoment) {
    for (Rounds rounds; rounds.next();) {
        Session session = new_session();
        {
            Desk desk(session);
            const auto hand = [&](std::uint32_t seed) {
                Chance chance(seed);
                for (int i = 0; i < 6; ++i) {
                    Scene scene = small_scene(all_methods[chance.pick(0, 5)]);
                    edit(scene, chance);
                    desk.show(scene);
                    chance.wait(10);
                }
            };
            const std::jthread other(hand, 2 * rounds.seed());
            hand(2 * rounds.seed() + 1);
        }  // the desk ends whatever it does
        Progress progress;
        const Scene scene = small_scene(Method::spao);
        expect_same(session.render(scene, progress), image_of(scene), scene, "after the end");
    }
}

/// Every long call, cancelled by another thread: it ends with the truth or with nothing, and what follows is right.
TEST(SessionRaces, EveryLongCallIsCancelledAtAnyMoment) {
    const std::pair<const char*, std::function<void(Session&, Scene&, Progress&)>> calls[] = {
        {"render", [](Session& s, Scene& scene, Progress& p) { s.render(scene, p); }},
        {"draft", [](Session& s, Scene& scene, Progress& p) { s.preview(scene, p); }},
        {"field",
         [](Session& s, Scene& scene, Progress& p) {
             if (!is_path_traced(scene.illumination) && scene.illumination.method != Method::none)
                 s.compute_field(scene, p);
         }},
        {"compare",
         [](Session& s, Scene& scene, Progress& p) {
             Session other = s.share_volume();
             compare_methods(other, scene, {scene.illumination.method}, p);
         }},
        {"measure",
         [](Session& s, Scene& scene, Progress& p) {
             if (scene.illumination.method != Method::spao && scene.illumination.method != Method::visibility) return;
             Session other = s.share_volume();
             measure_light(other, scene, p, 32);
         }},
        {"read", [](Session& s, Scene& scene, Progress& p) { s.show(read_volume(scene, p), p); }},
    };
    for (Rounds rounds; rounds.next();) {
        Chance chance(rounds.seed());
        for (const Method method : all_methods) {
            Session session = new_session();
            Scene scene = small_scene(method);
            for (const auto& [name, call] : calls) {
                edit(scene, chance);
                Progress progress;
                std::jthread canceller([&progress, seed = rounds.seed()] {
                    Chance(seed).wait(30);
                    progress.cancel();
                });
                const bool is_done = is_whole([&] { call(session, scene, progress); });
                canceller.join();
                if (is_done || name != std::string("read")) continue;
                Progress again;  // a volume that came half is no volume
                session.show(read_volume(scene, again), again);
            }
            Progress progress;
            expect_same(session.render(scene, progress), image_of(scene), scene, std::string(to_text(method)));
        }
    }
}

TEST(SessionRaces, SessionsThatShareVoxelsDoNotDisturbEachOther) {
    for (Rounds rounds; rounds.next();) {
        const Session first = new_session();
        std::mutex comparing;
        const auto work = [&](std::uint32_t seed) {
            Chance chance(seed);
            Scene scene = small_scene(all_methods[seed % 6]);
            Progress progress;
            Session session = first.share_volume();
            Session beside = session.share_volume();  // while others are made and render
            for (int i = 0; i < 3; ++i) {
                edit(scene, chance);
                session.render(scene, progress);
            }
            const Image image = session.render(scene, progress);
            const Image same = beside.render(scene, progress);
            const std::lock_guard lock(comparing);
            expect_same(image, image_of(scene), scene, std::string(to_text(scene.illumination.method)));
            expect_same(image, same, scene, std::string(to_text(scene.illumination.method)));
        };
        std::vector<std::jthread> workers;
        for (std::uint32_t i = 0; i < 4; ++i) workers.emplace_back(work, rounds.seed() + i);
    }
}

/// What is found at the first use and kept - tables of probes, of steps, light at nodes - belongs to values that many
/// threads may use at once.
TEST(SessionRaces, ValuesAreSharedWithWhatTheyFindLate) {
    for (Rounds rounds; rounds.next();) {
        for (const Method method : {Method::visibility, Method::transport, Method::none}) {
            const Scene scene = small_scene(method);
            const Device device = Device::cpu(2);
            Progress progress;
            Session session = new_session();
            session.render(scene, progress);
            const DeviceVolume& volume = session.volume();
            const auto cast = [&](const Medium& medium, const IlluminationField& light, const Lighting& lighting,
                                  int i) {
                RaySettings rays;
                rays.classification = i % 2 ? Classification::preintegrated : Classification::post;
                rays.step_voxels = 0.5 + 0.25 * double(i / 2 % 2);
                Lighting own = lighting;
                own.shading = i % 3 ? Shading::lambert : Shading::none;
                own.probe.rotation_deg = 30 * (i % 3);
                CameraSettings settings;
                settings.azimuth_deg = 60 * (i % 4);
                const Camera camera = make_camera(settings, volume.geometry(), volume.dimensions());
                own.probe_up = camera.orbit_up;
                Frame frame(16, 12);
                Progress none;
                raycast(device, medium, light, own, camera, rays, frame, none);
                return frame.rgba;
            };
            const auto fresh =
                [&](const std::function<void(const Medium&, const IlluminationField&, const Lighting&)>& f) {
                    Lighting lighting;
                    lighting.probe.source = "sky";
                    lighting.loaded_probe = load_probe("sky");
                    lighting.probe_up = Vec3{0, 0, 1};
                    const Medium medium = classify(device, volume, session.transfer_function(), Shape());
                    IlluminationField light;
                    illuminate(
                        device, medium, prepare(device, volume, scene.illumination, progress), lighting,
                        scene.illumination, [&](IlluminationField field) { light = std::move(field); }, progress);
                    f(medium, light, lighting);
                };
            constexpr int count = 8;
            std::vector<std::vector<float>> one_by_one(count), at_once(count);
            fresh([&](const auto&... values) {
                for (int i = 0; i < count; ++i) one_by_one[std::size_t(i)] = cast(values..., i);
            });
            fresh([&](const auto&... values) {
                std::vector<std::jthread> workers;
                for (int i = 0; i < count; ++i)
                    workers.emplace_back([&, i] { at_once[std::size_t(i)] = cast(values..., i); });
            });
            EXPECT_TRUE(one_by_one == at_once) << to_text(method);
        }
    }
}
