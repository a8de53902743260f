// Pictures of a card against the processor's: on each card there is, and again (cuda_emulated_test) on one of
// make-believe, where the bits must be the same.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>

#include "cuda/mirror.h"
#include "fixtures.h"
#ifdef CHIARO_CUDA_EMULATED
#include <cuda_runtime_api.h>

#include "bench.h"
#endif

using namespace chiaro;
using namespace chiaro::testing;

namespace {

#ifdef CHIARO_CUDA_EMULATED
constexpr double tolerance = 0;
#else
constexpr double tolerance = 1e-4;  // square roots and quotients are rounded alike, so usually 0 too
#endif

/// What a card's threads do too: one pixel at a time.
Device processor() { return Device::cpu(2, Isa::scalar); }

class Cards : public ::testing::Test {
protected:
    void SetUp() override {
        if (list_cards().empty()) GTEST_SKIP() << "skipped: no CUDA device";
        card = Device::cuda(0, processor());
    }

#ifdef CHIARO_CUDA_EMULATED
    void TearDown() override { EXPECT_GT(cuda_emulated::card().launches, launches_) << "the card did nothing"; }
    const std::size_t launches_ = cuda_emulated::card().launches;
#endif

    /// The same shot by both; returns the processor's.
    Frame expect_same(Shot shot, const Volume& volume, const IlluminationSettings& light = {}) {
        shot.device = processor();
        const Frame expected = shot.lit(volume, light);
        shot.device = card;
        const Difference d = difference(shot.lit(volume, light), expected, tolerance);
        EXPECT_EQ(d.pixels_beyond, 0) << "by up to " << d.max;
        EXPECT_GT(mean_alpha(expected), 0.02);
        return expected;
    }

    Device card;
};

template <class Voxel>
Volume shells_of(int n, double scale = 1) {
    return sampled<Voxel>({n, n + 3, n - 5}, [&](double x, double y, double z) { return scale * shells(x, y, z, n); });
}

Shot shaded() {
    Shot shot;
    shot.lighting.shading = Shading::phong;
    return shot;
}

}  // namespace

TEST_F(Cards, VolumesOfEveryTypeOfVoxel) {
    expect_same(shaded(), shells_of<std::uint8_t>(70));
    expect_same(shaded(), shells_of<std::uint16_t>(40));
    expect_same(shaded(), shells_of<float>(40));
}

TEST_F(Cards, EveryMode) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    shot.shape = {.mode = Mode::iso, .iso = {{.value = 90, .opacity = 0.5}, {.value = 180}}};
    expect_same(shot, volume);
    shot.shape = {.mode = Mode::mip};
    expect_same(shot, volume);
    shot.shape = {.clip = {.box = std::array{0.0, 0.5, 0.1, 1.0, 0.0, 1.0}, .planes = {{{1, 1, 0}, 40}}}};
    expect_same(shot, volume);
}

TEST_F(Cards, EveryWayOfClassifyingAndCompositing) {
    const Volume volume = shells_of<std::uint8_t>(40);
    for (const auto classification : {Classification::post, Classification::pre, Classification::preintegrated})
        for (const auto compositing : {Compositing::front_to_back, Compositing::back_to_front}) {
            Shot shot = shaded();
            shot.rays.classification = classification;
            shot.rays.compositing = compositing;
            expect_same(shot, volume);
        }
}

TEST_F(Cards, SeveralRaysAPixelEarlyEndsNoSkippingRaster) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    shot.rays = {.step_voxels = 0.7, .samples_per_pixel = 3, .early_termination = 0.01, .skip_empty = false};
    expect_same(shot, volume);
    shot.rays.ray_setup = RaySetup::raster;
    expect_same(shot, volume);
    shot.camera.projection = Projection::orthographic;
    expect_same(shot, volume);
}

// The reads at a sample of fields are gathers around it: those of the last node too.
TEST_F(Cards, EveryKindOfLight) {
    const Volume volume = shells_of<std::uint8_t>(36);
    const Shot shot = shaded();
    const Frame plain = expect_same(shot, volume);
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        IlluminationSettings light{.method = method};
        light.visibility.directions = 50;
        light.transport.grid = 16;
        for (const auto storage : {ShStorage::u8, ShStorage::f32}) {
            light.visibility.storage = storage;
            EXPECT_GT(difference(expect_same(shot, volume, light), plain, 0.01).pixels_beyond, 50);
        }
        Shot surfaces = shot;  // visibility by the sample's own normal
        surfaces.shape = {.mode = Mode::iso, .iso = {{.value = 90}}};
        expect_same(surfaces, volume, light);
    }
}

TEST_F(Cards, SweepVisibilityToTheSameCoefficients) {
    const Volume volume = shells_of<std::uint8_t>(36);
    IlluminationSettings light{.method = Method::visibility};
    Progress progress;
    const Medium medium = classify(upload(card, volume), two_materials(), {});
    for (const int bands : {2, 4})
        for (const int directions : {24, 600}) {  // one batch of each side, and several
            light.visibility.bands = bands, light.visibility.directions = directions;
            const ComputedField expected = compute_field(processor(), medium, {}, {}, light, progress);
            const ComputedField found = compute_field(card, medium, {}, {}, light, progress);
            const auto a = expected.volume.as<float>(), b = found.volume.as<float>();
            double worst = 0;
            for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double(a[i]) - b[i]));
            EXPECT_LE(worst, tolerance) << bands << " bands, " << directions << " directions";
        }
}

TEST_F(Cards, LocalHistogramsThatGlow) {
    const Volume volume = shells_of<std::uint8_t>(32);
    IlluminationSettings light{.method = Method::histogram};
    light.histogram.radius = 4, light.histogram.clusters = 64, light.histogram.cache = "none";
    for (const std::string glow : {"", "160:255=20"}) {
        light.histogram.glow = glow;
        light.histogram.effects.glow = !glow.empty();
        Progress progress;
        Frame frames[2] = {Frame(61, 47), Frame(61, 47)};
        for (const bool on_card : {false, true}) {
            const Device device = on_card ? card : processor();
            const DeviceVolume voxels = upload(device, volume);
            const Medium medium = classify(voxels, two_materials(), {});
            const Prepared prepared = prepare(voxels, light, progress);
            IlluminationField field;
            illuminate(
                device, medium, prepared, {}, light, [&](IlluminationField f) { field = f; }, progress);
            const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
            raycast(device, medium, field, {}, camera, {}, frames[on_card], progress);
        }
        EXPECT_EQ(difference(frames[1], frames[0], tolerance).pixels_beyond, 0) << glow;
        EXPECT_GT(mean_alpha(frames[0]), 0.02);
    }
}

TEST_F(Cards, PathsThroughCloudsAndToSurfaces) {
    const Volume volume = shells_of<std::uint8_t>(32);
    for (const std::string probe : {"white", "studio"})
        for (const Mode mode : {Mode::dvr, Mode::iso}) {
            const Medium medium = classify(upload(card, volume), two_materials(), {.mode = mode, .iso = {{90}}});
            Lighting lighting{.probe = {.source = probe}, .loaded_probe = load_probe(probe)};
            IlluminationSettings light{.method = Method::reference};
            light.reference.rays = 3;
            const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
            Progress progress;
            Frame expected(45, 37), frame(45, 37);
            const Outcome counted = trace_paths(processor(), medium, lighting, camera, {}, light, expected, progress);
            const Outcome outcome = trace_paths(card, medium, lighting, camera, {}, light, frame, progress);
            EXPECT_EQ(difference(frame, expected, tolerance).pixels_beyond, 0) << probe;
            EXPECT_NEAR(double(outcome.samples), double(counted.samples), tolerance * double(counted.samples));
            EXPECT_NEAR(outcome.paths.noise, counted.paths.noise, tolerance);
            EXPECT_GT(mean_alpha(expected), 0.02);
        }
}

TEST_F(Cards, LightAtPoints) {
    const Volume volume = shells_of<std::uint8_t>(32);
    const Medium medium = classify(upload(card, volume), two_materials(), {});
    const std::vector<Vec3> points{{16, 16, 16}, {5, 6, 7}, {-3, 12, 30}};
    IlluminationSettings light{.method = Method::reference};
    light.reference.rays = 2000;
    Progress progress;
    const Fluence expected = trace_fluence(processor(), medium, {}, {0, 0, 1}, points, light, progress);
    const Fluence found = trace_fluence(card, medium, {}, {0, 0, 1}, points, light, progress);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.mean[i][c], expected.mean[i][c], tolerance);
}

TEST_F(Cards, CountTheSamplesThatTheProcessorCounts) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(card, volume), two_materials(), {});
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    Progress progress;
    Frame frame(61, 47);
    const auto samples = [&](const Device& device) {
        return raycast(device, medium, {}, {}, camera, {}, frame, progress).samples;
    };
    const auto expected = samples(processor());
    EXPECT_GT(expected, 10000u);
    EXPECT_NEAR(double(samples(card)), double(expected), tolerance * double(expected));
}

// A session keeps on the card what its verbs keep on the host: an edit brings its cells, another camera nothing but the
// table.
TEST_F(Cards, AreHandedOnlyWhatChanged) {
    const auto copied = [&] { return card.stream->mirror()->copied_bytes(); };
    const auto of_mirror = [&](auto&& act) { return act(), copied(); };
    const Volume volume = shells_of<std::uint8_t>(40);
    const DeviceVolume voxels = upload(card, volume);
    Progress progress;
    Frame frame(61, 47);
    CameraSettings from;
    const auto show = [&](const Medium& medium) {
        raycast(card, medium, {}, {}, make_camera(from, volume.geometry, volume.dimensions), {}, frame, progress);
    };
    const Medium medium = classify(voxels, two_materials(), {});
    const auto first = of_mirror([&] { show(medium); });
    EXPECT_GT(first, volume.voxels.size());
    from.azimuth_deg = 80;
    EXPECT_EQ(of_mirror([&] { show(medium); }), first);
    const Medium edited = classify(voxels, constant(0.1), {});
    const auto second = of_mirror([&] { show(edited); });
    EXPECT_GT(second, first);
    EXPECT_LT(second - first, volume.voxels.size() / 20);
    const auto beside = card.beside();
    raycast(beside, medium, {}, {}, make_camera(from, volume.geometry, volume.dimensions), {}, frame, progress);
    EXPECT_EQ(copied(), second);  // another stream shares it
}

TEST_F(Cards, SessionsOfOneVolumeSideBySide) {
    Scene scene;
    scene.width = 61, scene.height = 47;
    scene.illumination.method = Method::spao;
    scene.transfer.points = two_materials();
    Progress progress;
    Session expected(processor()), one(card);
    expected.show(shells_of<std::uint8_t>(40), progress);
    one.show(shells_of<std::uint8_t>(40), progress);
    const Image image = expected.render(scene, progress);
    EXPECT_EQ(one.render(scene, progress).pixels, image.pixels);
    EXPECT_EQ(one.outcome().samples, expected.outcome().samples);
    const auto copied = card.stream->mirror()->copied_bytes();
    Session two = one.beside();
    std::thread other([&] {
        for (int turn = 0; turn < 3; ++turn) EXPECT_EQ(two.render(scene, progress).pixels, image.pixels);
    });
    Scene turned = scene;
    for (int turn = 0; turn < 3; ++turn) {
        turned.camera.azimuth_deg = 40 * turn;
        one.render(turned, progress);
    }
    other.join();
    EXPECT_LT(card.stream->mirror()->copied_bytes() - copied,
              copied / 2);  // the voxels are shared, light is each one's own
    EXPECT_EQ(one.draft(scene, progress).pixels, image.pixels);
}

TEST_F(Cards, LetGoOfWhatIsGone) {
    const auto held = [&] { return card.stream->mirror()->held_bytes(); };
    Shot shot = shaded();
    shot.device = card;
    shot(shells_of<std::uint8_t>(40));
    const auto small = held();
    for (int i = 0; i < 3; ++i) shot(shells_of<std::uint8_t>(40));
    EXPECT_EQ(held(), small);
}

TEST_F(Cards, StopWhenCancelled) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const Medium medium = classify(upload(card, volume), two_materials(), {});
    Frame frame(1200, 1000);  // more than are done at once
    Progress progress([&](std::string_view, double) { progress.cancel(); });
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    EXPECT_FALSE(raycast(card, medium, {}, {}, camera, {}, frame, progress).complete);
}

#ifdef CHIARO_CUDA_EMULATED

namespace {

std::string error_of(const std::function<void()>& act, ErrorCode code = ErrorCode::output) {
    try {
        act();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    return "";
}

/// As it was, once a test has made trouble.
class TroubledCards : public Cards {
protected:
    void TearDown() override {
        const cuda_emulated::Card whole;
        cuda_emulated::Card& card = cuda_emulated::card();
        card.count = whole.count, card.memory_bytes = whole.memory_bytes;
        card.driver_version = whole.driver_version, card.next_wait = whole.next_wait;
    }
};

}  // namespace

TEST_F(TroubledCards, AreNamedInOneSentence) {
    const auto choose = [] { Device::cuda(0, Device::cpu()); };
    EXPECT_EQ(error_of([] { Device::cuda(3, Device::cpu()); }), "--device cuda:3: there is no such card (0 to 0)");
    cuda_emulated::card().driver_version = 12020;
    EXPECT_EQ(error_of(choose), "--device cuda: the NVIDIA driver is for CUDA 12.2, and this build needs 13.0");
    EXPECT_TRUE(list_cards().empty());
    EXPECT_FALSE(choose_device(Device::cpu()).device.has_card());
    cuda_emulated::card().driver_version = 13000;
    cuda_emulated::card().count = 0;
    EXPECT_EQ(error_of(choose), "--device cuda: there is no NVIDIA card");
    cuda_emulated::card().driver_version = 0;
    EXPECT_EQ(error_of(choose), "--device cuda: there is no NVIDIA driver");
}

TEST_F(TroubledCards, AreChosenWhereTheyHaveMemory) {
    const DeviceChoice choice = choose_device(Device::cpu(2));
    EXPECT_EQ(choice.device.name(), "cuda:0");
    EXPECT_EQ(choice.sentence.find("on cuda:0 (Emulated), "), 0u) << choice.sentence;
    cuda_emulated::card().memory_bytes = std::size_t(700) << 20;
    const DeviceChoice small = choose_device(Device::cpu(2));
    EXPECT_EQ(small.device.name(), "cpu");
    EXPECT_EQ(small.sentence.find("cuda:0 (Emulated) has "), 0u) << small.sentence;
    EXPECT_NE(small.sentence.find("the processor does the work"), std::string::npos) << small.sentence;
}

TEST_F(TroubledCards, WithoutRoomGiveWayOnlyWhereTheyWereChosenByThemselves) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    const Frame expected = shot(volume);
    const DeviceChoice choice = choose_device(Device::cpu(2));
    cuda_emulated::card().memory_bytes = cuda_emulated::card().held_bytes + 100000;
    shot.device = card;
    EXPECT_NE(error_of([&] { shot(volume); }).find("MiB more do not fit: 0 of"), std::string::npos);
    shot.device = choice.device;
    EXPECT_EQ(difference(shot(volume), expected, 0).pixels_beyond, 0);
    EXPECT_NE(shot.device.note().find("; the processor does the work"), std::string::npos) << shot.device.note();
    EXPECT_EQ(choice.device.beside().note(), "");
}

TEST_F(TroubledCards, ThatAreLostAreTold) {
    Shot shot = shaded();
    shot.device = card;
    const Volume volume = shells_of<std::uint8_t>(40);
    cuda_emulated::card().next_wait = cudaErrorIllegalAddress;
    EXPECT_EQ(error_of([&] { shot(volume); }),
              "cuda:0 (Emulated) was lost: an illegal memory access was encountered; start again, or use --device cpu");
}

TEST_F(TroubledCards, HoldNothingInTheEnd) {
    const auto before = cuda_emulated::card().held_bytes;
    {
        Shot shot = shaded();
        shot.device = Device::cuda(0, processor());
        shot(shells_of<std::uint8_t>(40));
        EXPECT_GT(cuda_emulated::card().held_bytes, before);
    }
    EXPECT_EQ(cuda_emulated::card().held_bytes, before);
}

TEST_F(Cards, AreTimedByTheBench) {
    Progress progress;
    const bench::Setup setup{.device = card, .quick = true, .runs = 2, .progress = progress};
    std::vector<bench::Row> rows;
    bench::run(setup, {{"card"}, "copy|upload|download|shells256-sparse"},
               [&](const bench::Row& row) { rows.push_back(row); });
    ASSERT_EQ(rows.size(), 7u);
    for (const bench::Row& row : rows) {
        EXPECT_EQ(row.value.runs, 2) << row.name << row.note;
        EXPECT_GT(row.value.min, 0) << row.name;
        EXPECT_EQ(row.ratio.has_value(), row.name != "card/copy") << row.name;
    }
}

// The make-believe card must be one: what the tests rely on.
TEST(EmulatedCardDeathTest, KeepsTheHostOut) {
    const Device card = Device::cuda(0, Device::cpu(1));
    cuda::Array<int> numbers(*card.stream, 10);
    int host[10] = {};
    EXPECT_DEATH(std::memcpy(host, numbers.data(), 4), "");
    EXPECT_DEATH(card.stream->upload(numbers.data() + 5, host, sizeof host), "leaves the card's memory");
    const void* pointer = host;
    EXPECT_DEATH(cuda_emulated::refuse_host_pointers_in(pointer), "pointer of the host");
    numbers.zero();
    card.stream->download(host, numbers.data(), sizeof host);
    card.stream->wait();
    EXPECT_EQ(host[9], 0);
}

TEST(EmulatedCardDeathTest, DoesItsWorkWhenTheHostWaits) {
    const Device card = Device::cuda(0, Device::cpu(1));
    const cuda::Array<int> numbers(*card.stream, 1);
    int sent = 1, back = 0;
    card.stream->upload(numbers.data(), &sent, sizeof sent);
    card.stream->download(&back, numbers.data(), sizeof back);
    sent = 2;  // too early
    EXPECT_EQ(back, 0);
    card.stream->wait();
    EXPECT_EQ(back, 2);
}

#endif
