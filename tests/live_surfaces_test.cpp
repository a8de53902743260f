// Light at surfaces in the volume by the methods that are live: against the albedo, and against the reference
// (docs/theory/light.md).
#include <chiaro/render.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "surface_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// What an eye sees of a volume that a live method lights.
Frame shown(const Volume& volume, const Look& look, const IlluminationSettings& settings,
            const TransferFunction& tf = skin(), const Lighting& lighting = matte, const Shape& shape = {},
            const RaySettings& rays = {}) {
    const Device device = tested_device();
    const Medium medium = classify(upload(device, volume), tf, shape);
    IlluminationField field;
    Progress progress;
    illuminate(
        device, medium, Prepared(), lighting, settings, [&](IlluminationField finer) { field = std::move(finer); },
        progress);
    Frame frame(look.pixels, look.pixels);
    raycast(device, medium, field, lighting, camera_of(look), rays, frame, progress);
    return frame;
}
/// What the frame shows of a grey of 1, where it covers.
double brightness(const Frame& frame) { return mean(irradiance_of_columns(frame)); }

constexpr Method live[] = {Method::visibility, Method::transport};

IlluminationSettings by(Method method) { return {.method = method}; }
/// Where no light goes to and fro.
IlluminationSettings roughly_by(Method method) { return {.method = method, .transport = {.error = 0.1}}; }
/// What its reference follows.
PathOptions followed_by(Method method) {
    return {.bounces = method == Method::visibility ? std::optional(0) : std::nullopt, .surfaces = true};
}

// The softer an edge, the more of it lies between a node and the air.
TEST(LiveSurfaces, ABallIsAsBrightAsItsAlbedo) {
    for (const Method method : live)
        for (const auto& [edge, missing] :
             {std::pair{0.4, 0.02}, {0.8, 0.02}, {1.5, 0.03}, {2.0, 0.045}, {3.0, 0.075}}) {
            const double found = brightness(shown(ball(edge, 22.37), at_ball(22.37), by(method)));
            if (std::getenv("CHIARO_SHOW")) fmt::print("{} edge {}: {:.4f}\n", to_text(method), edge, found);
            EXPECT_NEAR(found, 1, missing) << to_text(method) << edge;
        }
}

TEST(LiveSurfaces, ACutIsASurface) {
    for (const Method method : {Method::spao, Method::visibility, Method::transport})
        for (const double degrees : {0.0, 30.0, 45.0}) {
            const double a = degrees * pi / 180;
            const Vec3 normal{std::sin(a), 0, std::cos(a)};
            Shape shape;
            shape.clip.planes = {{normal, dot(normal, centre)}};
            const Look look{centre + 25 * normal, normal, {0, 1, 0}, 8};
            Lighting lighting = matte;
            if (method == Method::spao) lighting.shading = Shading::none;
            for (const Compositing order : {Compositing::front_to_back, Compositing::back_to_front}) {
                const Frame frame =
                    shown(ball(0.8, 22.37), look, roughly_by(method), skin(), lighting, shape, {.compositing = order});
                EXPECT_NEAR(brightness(frame), 1, 0.02) << to_text(method) << degrees;
            }
        }
}

TEST(LiveSurfaces, ABorderIsASurface) {
    const Volume volume = volume_of([](Vec3) { return 200.0; });
    const Vec3 middle{31.5, 31.5, 31.5};
    const Lighting half{.specular = 0, .probe = {.source = "half"}, .loaded_probe = rows_of({1, 0})};
    for (const Vec3 way : {Vec3{-1, 0, 0}, Vec3{0.1, 0.2, -0.9}}) {
        const Vec3 normal = normalized(way);
        const Look look{middle + 60 * normal, normal, normalized(cross(normal, {1, 2, 4})), 8};
        const double up = std::abs(way.z) > 0.8 ? (way.z > 0 ? 1 : 0) : 0.5;
        for (const Method method : live) {
            EXPECT_NEAR(brightness(shown(volume, look, roughly_by(method))), 1, 0.01) << to_text(method);
            EXPECT_NEAR(brightness(shown(volume, look, roughly_by(method), skin(), half)), up, 0.02) << to_text(method);
            // As particles: what is dark remains dark.
            IlluminationSettings none = roughly_by(method);
            none.surfaces = SurfaceModel::none;
            EXPECT_LT(brightness(shown(volume, look, none)), 0.8);
        }
    }
}

// A film of opacity .2, two voxels thick, lit from behind alone.
TEST(LiveSurfaces, AFilmIsLitFromBehind) {
    const Lighting below{.specular = 0, .probe = {.source = "half"}, .loaded_probe = rows_of({0, 1})};
    const Volume film = volume_of([](Vec3 p) { return logistic(std::abs(p.z - 31.4) - 1, 0.4); });
    const double of_voxel = 1 - std::sqrt(0.8);
    TransferFunction tf = skin(0, 200);
    tf.points = {{0, {grey, grey, grey}, 0}, {200, {grey, grey, grey}, of_voxel}};
    const Look look{{31.5, 31.5, 50}, {0, 0, 1}, {1, 0, 0}, 8};
    for (const Method method : live) {
        const double truth = brightness(seen(film, look, followed_by(method), 512, tf, below)),
                     found = brightness(shown(film, look, by(method), tf, below));
        if (std::getenv("CHIARO_SHOW")) fmt::print("film {}: {:.4f} of {:.4f}\n", to_text(method), found, truth);
        EXPECT_GT(truth, 0.05);
        EXPECT_NEAR(found / truth, 1, 0.06) << to_text(method);
    }
}

// From within a hollow ball, through whose hole light comes.
TEST(LiveSurfaces, AHollowBallFromWithin) {
    const Volume volume = volume_of([](Vec3 p) {
        const Vec3 d = p - centre;
        const double wall = std::abs(length(d) - 18) - 3, hole = std::hypot(d.x, d.y) - 8;
        return logistic(d.z > 0 ? std::max(wall, -hole) : wall, 0.8);
    });
    const Look look{centre + Vec3{0, 0, -8}, {0, 0, 1}, {1, 0, 0}, 6};
    for (const Method method : live) {
        const double truth = brightness(seen(volume, look, followed_by(method), 256)),
                     found = brightness(shown(volume, look, by(method)));
        if (std::getenv("CHIARO_SHOW")) fmt::print("hollow {}: {:.4f} of {:.4f}\n", to_text(method), found, truth);
        // V is read 1.5 nodes off the wall, from where the hole of a ball of 18 voxels is a third larger.
        EXPECT_NEAR(found / truth, 1, method == Method::visibility ? 0.2 : 0.12) << to_text(method);
    }
}

TEST(LiveSurfaces, AHardStepIsAnIsosurface) {
    const Volume volume = volume_of([](Vec3 p) { return p.z < 31.4 && length(p - centre) < 24 ? 200.0 : 0.0; });
    const Look look{centre + 20 * normalized(Vec3{0.2, 0.1, 1}), normalized(Vec3{0.2, 0.1, 1}), {0, 1, 0}, 6};
    Shape iso;
    iso.mode = Mode::iso;
    const double srgb = 0.9063;  // of a linear .8
    iso.iso = {{100, Rgb{srgb, srgb, srgb}}};
    for (const Method method : live) {
        const TransferFunction hard = skin(99, 101);
        EXPECT_NEAR(brightness(shown(volume, look, by(method), hard)),
                    brightness(shown(volume, look, by(method), hard, matte, iso)), 0.03)
            << to_text(method);
    }
}

}  // namespace
