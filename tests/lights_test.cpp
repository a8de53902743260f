// Several lights: their shares add up, from directions and from points; as an environment map they throw shadows.
#include <chiaro/error.h>
#include <chiaro/render.h>
#include <chiaro/scene.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "surface_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

Light sun(double azimuth_deg, double elevation_deg, Rgb color = {1, 1, 1}) {
    return {.headlight = false, .azimuth_deg = azimuth_deg, .elevation_deg = elevation_deg, .color = color};
}
Light lamp(Vec3 at, Rgb color) { return {.headlight = false, .color = color, .position_mm = at}; }
Vec3 towards(const Light& light) {
    return orbit_direction(radians(light.azimuth_deg), radians(light.elevation_deg), {0, 0, 1});
}

/// A plane of one normal in voxels of other edges, opaque at once, of a grey of .5, that is looked at along -x.
struct Plane {
    Volume volume = sampled<std::uint8_t>({48, 48, 48}, [](double x, double y, double) { return 240 - 4 * x - y; });
    Vec3 normal;
    Shot shot;
    Vec3 met;  ///< where the middle ray meets it

    Plane() {
        volume.geometry.spacing_mm = {1, 0.5, 1.5};
        volume.geometry.origin_mm = {-20, 5, 3};
        normal = normalized({4, 2, 0});
        shot.tf = constant(0.9999, {0.5, 0.5, 0.5});
        shot.tf.opacity_unit = 0.01, shot.tf.rgb_space = RgbSpace::srgb;
        shot.shape.threshold_low = 100, shot.shape.threshold_high = 300;
        shot.shape.color = ColorMode::display;
        shot.camera = along_x;
        shot.rays.step_voxels = 0.02;
        shot.width = shot.height = 1;  // 4 x + y = 140 at y = 23.5
        met = volume.geometry.world_from_voxel({116.5 / 4, 23.5, 23.5});
    }

    Rgb pixel(const std::vector<Light>& lights, Shading shading = Shading::phong) const {
        Shot shown = shot;
        shown.lighting = {.shading = shading, .ambient = 0.1, .diffuse = 0.6, .specular = 0.4, .shininess = 8};
        shown.lighting.lights = lights;
        const Frame frame = shown(volume);
        EXPECT_NEAR(frame.rgba[3], 1, 1e-4);
        return {frame.rgba[0], frame.rgba[1], frame.rgba[2]};
    }

    Rgb expected(const std::vector<Light>& lights) const {
        Rgb sum{0.05, 0.05, 0.05};
        for (const Light& light : lights) {
            const Vec3 eye{1, 0, 0};
            const Vec3 l = light.headlight     ? eye
                           : light.position_mm ? normalized(*light.position_mm - met)
                                               : towards(light);
            const double nl = dot(normal, l), nh = dot(normal, normalized(l + eye));
            const double shine = 0.4 * std::pow(std::max(nl < 0 ? -nh : nh, 0.0), 8);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += light.color[c] * (0.5 * 0.6 * std::abs(nl) + shine);
        }
        return sum;
    }
};

void expect_near(const Rgb& found, const Rgb& right, double within, const char* what) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], right[c], within) << what << c;
}

}  // namespace

TEST(Lights, AddUp) {
    const Plane plane;
    const std::vector<Light> lights{sun(30, 20, {0.5, 0.2, 0.1}), lamp({60, 40, 30}, {0.1, 0.6, 0.3}),
                                    Light{.color = {0.3, 0.3, 0.3}}, lamp({5, -10, 80}, {0.4, 0, 0.9}),
                                    sun(-160, -10, {0.1, 0.2, 0.8})};
    for (std::size_t count = 0; count <= lights.size(); ++count) {
        const std::vector<Light> some(lights.begin(), lights.begin() + std::ptrdiff_t(count));
        expect_near(plane.pixel(some), plane.expected(some), 2e-3, "some ");
    }
    expect_near(plane.pixel({lights[1]}), plane.expected({lights[1]}), 2e-3, "a point alone ");
    expect_near(plane.pixel(lights, Shading::none), {0.5, 0.5, 0.5}, 1e-3, "unshaded ");
}

// What does not shine changes nothing, to the bit; access scales all lights alike.
TEST(Lights, OneIsAsItWas) {
    const Volume volume = ball(1.5, 20);
    for (const Method method : {Method::none, Method::spao}) {
        Shot shot;
        shot.tf = skin();
        const auto shown = [&](const std::vector<Light>& lights) {
            shot.lighting.lights = lights;
            return shot.lit(volume, {.method = method}).rgba;
        };
        shot.lighting = {.ambient = 0};
        const auto one = shown({sun(20, 30)});
        EXPECT_EQ(shown({sun(20, 30), sun(70, 10, {0, 0, 0}), lamp({1, 2, 3}, {0, 0, 0})}), one);
        const auto other = shown({lamp({90, 80, 70}, {0.2, 0.3, 0.4})}),
                   both = shown({lamp({90, 80, 70}, {0.2, 0.3, 0.4}), sun(20, 30)});
        double off = 0, light = 0;
        for (std::size_t i = 0; i < one.size(); ++i)
            if (i % 4 != 3) off = std::max(off, std::abs(double(both[i]) - one[i] - other[i])), light += other[i];
        EXPECT_LT(off, 1e-5) << int(method);
        EXPECT_GT(light, 1) << int(method);
    }
}

TEST(Lights, AreKeptInScenesAndText) {
    const std::vector<Light> lights{sun(30, -20, {1, 0.5, 0}), Light{.color = {0.5, 1, 1}},
                                    lamp({1, 2.5, -3}, {1, 1, 1}), Light{}};
    EXPECT_EQ(to_text(lights), "30,-20,1,0.5,0;headlight,0.5,1,1;at:1,2.5,-3,1,1,1;headlight");
    for (const std::size_t count : {0u, 1u, 2u, 4u}) {
        Scene scene;
        scene.volume = "sample:ball";
        scene.lighting.lights = {lights.begin(), lights.begin() + std::ptrdiff_t(count)};
        std::vector<std::string> unknown;
        EXPECT_EQ(parse_scene(to_json(scene), {}, {}, unknown).lighting.lights, scene.lighting.lights) << count;
        EXPECT_TRUE(unknown.empty());
    }
    const auto parsed = [](const std::string& light) {
        std::vector<std::string> unknown;
        return parse_scene(R"({"volume": {"file": "sample:ball"}, "shading": {"light": )" + light + "}}", {}, {},
                           unknown)
            .lighting.lights;
    };
    EXPECT_EQ(parsed(R"([30, 20, "red"])"), (std::vector{sun(30, 20, {1, 0, 0})}));
    EXPECT_EQ(parsed(R"([[30, 20], "headlight", "at:1,2,3,red"])"),
              (std::vector{sun(30, 20), Light{}, lamp({1, 2, 3}, {1, 0, 0})}));
    EXPECT_THROW(parsed(R"(["headlight", "left"])"), Error);
    EXPECT_THROW(parsed(R"("at:1,2")"), Error);
    EXPECT_THROW(parsed("[[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2],[1,2]]"), Error);
}

TEST(Lights, AsAProbeMustHaveDirections) {
    const auto refused = [](const std::vector<Light>& lights, const char* why) {
        Lighting lighting;
        lighting.probe.source = "lights", lighting.lights = lights;
        try {
            load_probe(lighting);
            ADD_FAILURE() << why;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
    };
    refused({}, "there is none");
    refused({sun(1, 2), Light{}}, "headlight");
    refused({lamp({1, 2, 3}, {1, 1, 1})}, "a light at a point");
}

namespace {

/// A ball between three lights, one of them behind it, and a rod that throws its shadow on it.
Frame ball_by(Method method, int paths) {
    const Volume volume = volume_of([](Vec3 p) {
        const double rod = std::hypot(p.x - 52, p.z - 40) - 3.5;
        return logistic(std::min(length(p - centre) - 16, rod), 0.8);
    });
    Lighting lighting{.specular = 0};
    lighting.probe.source = "lights";
    lighting.lights = {sun(0, 35, {0.9, 0.9, 0.9}), sun(100, 10, {0.7, 0.3, 0.2}), sun(200, -20, {0.2, 0.4, 0.8})};
    lighting.loaded_probe = load_probe(lighting);
    const Look look{centre + 60 * normalized({0.6, 0.5, 0.4}), normalized({0.6, 0.5, 0.4}), normalized({-0.5, 0.6, 0}),
                    22, 48};
    if (method == Method::reference)
        return seen(volume, look, {.bounces = std::optional(0), .surfaces = true}, paths, skin(), lighting);
    const Device device = tested_device();
    const Medium medium = classify(upload(device, volume), skin(), {});
    IlluminationSettings settings{.method = method};
    settings.scattering.bounces.most = 0;
    IlluminationField field;
    Progress progress;
    illuminate(
        device, medium, Prepared(), lighting, settings, [&](IlluminationField f) { field = std::move(f); }, progress);
    Frame frame(look.pixels, look.pixels);
    raycast(device, medium, field, lighting, camera_of(look), {}, frame, progress);
    return frame;
}

/// Of means over 8 × 8 pixels, over the mean of what is right.
double distance_of_means(const Frame& found, const Frame& right) {
    double squares = 0, all = 0;
    int count = 0;
    for (int y = 0; y < right.height; y += 8)
        for (int x = 0; x < right.width; x += 8)
            for (int c = 0; c < 3; ++c) {
                double a = 0, b = 0;
                for (int i = 0; i < 64; ++i) {
                    const std::size_t at = 4 * (std::size_t(y + i / 8) * right.width + x + i % 8) + std::size_t(c);
                    a += found.rgba[at] / 64, b += right.rgba[at] / 64;
                }
                squares += (a - b) * (a - b), all += b, ++count;
            }
    return std::sqrt(squares / count) / (all / count);
}

}  // namespace

// Paths and live methods see the same lights, shadows included.
TEST(Lights, AreThoseOfThePathTracer) {
    const Frame truth = ball_by(Method::reference, 128);
    for (const Method method : {Method::visibility, Method::transport}) {
        const double found = distance_of_means(ball_by(method, 0), truth);
        if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {:.4f}\n", to_text(method), found);
        EXPECT_LT(found, 0.1) << to_text(method);
    }
}
