// Pictures of levels by bricks are those of whole ones.
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "classify/paged_medium.h"

using namespace chiaro;

namespace {

constexpr std::int32_t plenty = 1 << 12;  // of bricks

/// A level of which all that rays ask for is read, in passes.
struct Paged {
    PagedLevel level;
    Medium medium;
    int passes = 0;
    bool is_complete = true;

    Paged(const std::shared_ptr<const BrickSource>& source, int number, const Medium& whole, std::int32_t room = plenty)
        : level(source, number, whole.data().volume, room), medium(paged_medium(level, whole)) {}

    Frame draw(const Device& device, const IlluminationField& field, const Lighting& lighting, const Camera& camera,
               const RaySettings& rays) {
        Progress progress;
        Frame frame(64, 48);
        for (;;) {
            level.forget_seen();
            raycast(device, medium, field, lighting, camera, rays, frame, progress);
            ++passes;
            const auto missing = level.missing();
            if (missing.empty()) return frame;
            if (!(is_complete = level.read(missing, progress))) return frame;
        }
    }
};

/// A volume, and how it looks.
struct Subject {
    std::shared_ptr<const BrickSource> source;
    TransferFunction tf;
    Progress progress{};

    explicit Subject(const std::string& name, int size)
        : source(open_sample(name, size)), tf(sample_transfer_function(name)) {
        tf.opacity_unit = source->header().geometry.smallest_spacing_mm(), tf.opacity_unit_is_mm = true;
    }
    DeviceVolume whole(int level) { return upload(Device::cpu(2), read_level(*source, level, progress)); }
    Medium looks(int level, const Shape& shape = {}) { return classify(whole(level), tf, shape); }
    Camera camera(double azimuth_deg = 35, double zoom = 1) const {
        CameraSettings settings;
        settings.azimuth_deg = azimuth_deg, settings.zoom = zoom;
        return make_camera(settings, source->header().geometry, source->header().dimensions);
    }
};

Frame whole_frame(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                  const Camera& camera, const RaySettings& rays) {
    Progress progress;
    Frame frame(64, 48);
    raycast(device, medium, field, lighting, camera, rays, frame, progress);
    return frame;
}

IlluminationField light_of(const Medium& medium, const Lighting& lighting, const IlluminationSettings& settings) {
    IlluminationField field;
    Progress progress;
    illuminate(
        Device::cpu(2), medium, Prepared(), lighting, settings,
        [&](IlluminationField finer) { field = std::move(finer); }, progress);
    return field;
}

}  // namespace

TEST(Bricks, PicturesAreThoseOfTheWholeLevelBitForBit) {
    Subject shown("shells", 96);
    for (const Mode mode : {Mode::dvr, Mode::additive, Mode::iso}) {
        Shape shape{.mode = mode};
        if (mode == Mode::iso) shape.iso = {{.value = 100, .color = {}, .opacity = 0.4}, {.value = 200}};
        const Medium whole = shown.looks(0, shape), coarse = shown.looks(1, shape);
        for (const Isa isa : available_isas()) {
            const Device device = Device::cpu(2, isa);
            for (const Compositing order : {Compositing::front_to_back, Compositing::back_to_front}) {
                RaySettings rays{.compositing = order, .samples_per_pixel = 2};
                Paged paged(shown.source, 0, coarse);
                const Camera camera = shown.camera(35, 1.5);
                const Frame bricks = paged.draw(device, {}, {}, camera, rays),
                            dense = whole_frame(device, whole, {}, {}, camera, rays);
                EXPECT_GT(paged.passes, 1);
                ASSERT_EQ(bricks.rgba, dense.rgba) << int(mode) << ' ' << name_of(isa) << ' ' << int(order);
            }
        }
    }
}

TEST(Bricks, LightIsThatOfTheWholeLevelBitForBit) {
    Subject shown("tubes", 80);
    const Medium whole = shown.looks(0);
    Lighting lighting;
    lighting.probe.source = "sky";
    lighting.loaded_probe = load_probe("sky");
    lighting.probe_up = Vec3{0, 0, 1};
    for (const Method method : {Method::spao, Method::visibility, Method::transport})
        for (const Classification classification : {Classification::post, Classification::pre}) {
            const Lighting& light = method == Method::spao ? Lighting{} : lighting;
            const IlluminationField field = light_of(whole, light, {.method = method});
            const RaySettings rays{.classification = classification};
            Paged paged(shown.source, 0, whole);  // the light's grid is its own
            const Frame bricks = paged.draw(Device::cpu(2), field, light, shown.camera(), rays),
                        dense = whole_frame(Device::cpu(2), whole, field, light, shown.camera(), rays);
            EXPECT_GT(paged.level.bricks_read(), 4u);
            ASSERT_EQ(bricks.rgba, dense.rgba) << int(method) << ' ' << int(classification);
        }
}

TEST(Bricks, LightOfACoarseLevelFallsInItsPlace) {
    Subject shown("ball", 128);
    const Medium whole = shown.looks(0), coarse = shown.looks(1);
    Lighting lighting;
    lighting.loaded_probe = load_probe("studio");
    lighting.probe.source = "studio";
    lighting.probe_up = Vec3{0, 0, 1};
    for (const Method method : {Method::spao, Method::visibility}) {
        Paged paged(shown.source, 0, coarse);
        const IlluminationField of_coarse = light_of(coarse, lighting, {.method = method}),
                                of_whole = light_of(whole, lighting, {.method = method});
        const Frame bricks = paged.draw(Device::cpu(2), of_coarse, lighting, shown.camera(), {}),
                    dense = whole_frame(Device::cpu(2), whole, of_whole, lighting, shown.camera(), {});
        double squares = 0;
        for (std::size_t i = 0; i < dense.rgba.size(); ++i) squares += std::pow(bricks.rgba[i] - dense.rgba[i], 2);
        EXPECT_LT(std::sqrt(squares / double(dense.rgba.size())), 0.02) << int(method);
    }
}

TEST(Bricks, PicturesDependNeitherOnThreadsNorOnWhatWasReadBefore) {
    Subject shown("shells", 128);
    const Medium coarse = shown.looks(2);
    const auto draw = [&](Paged& paged, int threads, double azimuth) {
        return paged.draw(Device::cpu(threads), {}, {}, shown.camera(azimuth), {}).rgba;
    };
    Paged fresh(shown.source, 0, coarse), one_thread(shown.source, 0, coarse), used(shown.source, 0, coarse);
    const auto picture = draw(fresh, 2, 35);
    EXPECT_EQ(picture, draw(one_thread, 1, 35));
    draw(used, 2, 200), draw(used, 2, 100);
    EXPECT_EQ(picture, draw(used, 2, 35));
    // Room for what one picture shows, but not for all.
    Paged narrow(shown.source, 0, coarse, std::int32_t(fresh.level.bricks_there()) + 4);
    draw(narrow, 2, 215);
    const auto again = draw(narrow, 2, 35);
    if (narrow.is_complete) EXPECT_EQ(picture, again);
    Paged too_narrow(shown.source, 0, coarse, 3);
    draw(too_narrow, 2, 35);
    EXPECT_FALSE(too_narrow.is_complete);
}

TEST(Bricks, EmptyOnesAreNotKeptAndAnEditFindsThem) {
    Subject shown("shells", 128);
    const Medium coarse = shown.looks(1);
    Paged paged(shown.source, 0, coarse);
    paged.draw(Device::cpu(2), {}, {}, shown.camera(), {});
    EXPECT_LT(paged.level.bricks_there(), 64u);
    shown.tf.points = {{0, {1, 1, 1}, 0}, {9, {1, 1, 1}, 0}, {10, {1, 1, 1}, 0.01}, {255, {1, 1, 1}, 0.02}};
    const Medium other = shown.looks(1), whole = shown.looks(0);
    paged.medium = paged_medium(paged.level, other);
    const Frame bricks = paged.draw(Device::cpu(2), {}, {}, shown.camera(), {});
    EXPECT_EQ(bricks.rgba, whole_frame(Device::cpu(2), whole, {}, {}, shown.camera(), {}).rgba);
}
