// Light at surfaces in the volume by the methods that are live: against the albedo, and against the reference
// (docs/theory/light.md).
#include <chiaro/render.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "surface_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

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

// Neither the step of a ray nor the distance of nodes makes light.
TEST(LiveSurfaces, StepsAndNodesDoNotShow) {
    const Volume volume = ball(0.8, 22.37);
    const Look look = at_ball(22.37);
    const double truth = brightness(seen(volume, look, {.bounces = 0, .surfaces = true}, 64));
    const auto check = [&](const IlluminationSettings& settings, double step, double within, const std::string& what) {
        const double found = brightness(shown(volume, look, settings, skin(), matte, {}, {.step_voxels = step}));
        if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {:.4f} of {:.4f}\n", what, found, truth);
        EXPECT_NEAR(found / truth, 1, within) << what;
    };
    for (const Method method : live)
        for (const double step : {0.125, 0.5, 1.0})
            check(by(method), step, 0.015, fmt::format("{} step {}", to_text(method), step));
    for (const int nodes : {1, 2, 4}) {
        IlluminationSettings swept = by(Method::visibility), scattered = by(Method::transport);
        swept.visibility.subsample = nodes, scattered.transport.grid = n / nodes;
        check(swept, 0.5, 0.03, fmt::format("visibility 1:{}", nodes));
        check(scattered, 0.5, 0.03, fmt::format("transport 1:{}", nodes));
    }
}

/// A sky of .2 with a sun 11° wide at its zenith: E / π of a normal is .2 + .5 max(0, up).
Lighting sunny() {
    std::vector<float> rows(32, 0.2f);
    rows[0] += float(0.5 / std::pow(std::sin(pi / 32), 2));
    return {.specular = 0, .probe = {.source = "sunny"}, .loaded_probe = rows_of(rows)};
}
double under_sunny(double up) { return 0.2 + 0.5 * std::max(up, 0.0); }
double under_half_a_sky(double up) { return (1 + up) / 2; }

struct Errors {
    double rms, worst;  ///< over the mean of what is right
};
/// Of a ball seen from the side, but for its limb; `right`: E / π of a normal that rises so.
Errors errors_on_a_ball(Method method, const Lighting& lighting, double (*right)(double up)) {
    constexpr double radius = 22.37, shown_part = 0.8;
    const Look look{centre + Vec3{40, 0, 0}, {1, 0, 0}, {0, 0, 1}, shown_part * radius, 48};
    const Frame frame = shown(ball(0.8, radius), look, by(method), skin(), lighting);
    double squares = 0, all = 0, worst = 0;
    int count = 0;
    const auto across = [&](int pixel) { return shown_part * (2 * (pixel + 0.5) / look.pixels - 1); };
    for (int y = 0; y < look.pixels; ++y)
        for (int x = 0; x < look.pixels; ++x) {
            if (std::hypot(across(x), across(y)) > 0.85) continue;
            const double truth = right(across(x));
            const double error = frame.rgba[4 * std::size_t(y * look.pixels + x) + 1] / grey - truth;
            squares += error * error, all += truth, worst = std::max(worst, std::abs(error)), ++count;
        }
    return {std::sqrt(squares * count) / all, worst * count / all};
}

TEST(LiveSurfaces, ABallHasTheLightOfItsHemisphere) {
    const Lighting half{.specular = 0, .probe = {.source = "half"}, .loaded_probe = rows_of({1, 0})};
    for (const Method method : live)
        for (const auto& [lighting, right] : {std::pair{half, &under_half_a_sky}, {sunny(), &under_sunny}}) {
            const Errors found = errors_on_a_ball(method, lighting, right);
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("ball {} {}: RMS {:.4f}, worst {:.4f}\n", to_text(method), lighting.probe.source, found.rms,
                           found.worst);
            EXPECT_LT(found.rms, 0.02) << to_text(method) << lighting.probe.source;
            EXPECT_LT(found.worst, 0.06) << to_text(method) << lighting.probe.source;
        }
}

/// A plate 16 voxels over a floor, the sun at the zenith: how wide the edge of its shadow is, from a tenth to nine
/// tenths of the sun's light. By sixteen harmonics it is as wide as the plate is high.
TEST(LiveSurfaces, ASunCastsASharpShadow) {
    const Volume volume = volume_of([](Vec3 p) {
        const double plate = std::max(std::abs(p.z - 36) - 1.5, p.x - 31.7);
        return logistic(std::min(p.z - 18.4, plate), 0.4);
    });
    const Vec3 normal = normalized({0, -1, 1});  // past the plate: the volume ends before it
    const Look look{Vec3{31.7, 8, 18.4} + 40 * normal, normal, {1, 0, 0}, 12, 48};
    for (const Method method : live) {
        const auto of_floor = [&](const Frame& frame) {
            std::vector<double> light(std::size_t(look.pixels), 0);
            for (int y = 16; y < 32; ++y)
                for (int x = 0; x < look.pixels; ++x)
                    light[std::size_t(x)] += frame.rgba[4 * std::size_t(y * look.pixels + x) + 1] / grey / 16;
            return light;
        };
        const auto light = of_floor(shown(volume, look, roughly_by(method), skin(), sunny())),
                   truth = of_floor(seen(volume, look, followed_by(method), 64, skin(), sunny()));
        const double dark = light.front(), bright = light.back();
        double wide = 0;
        for (const double column : light) {
            const double share = (column - dark) / (bright - dark);
            if (share > 0.1 && share < 0.9) wide += 2 * look.half_width / look.pixels;
        }
        if (std::getenv("CHIARO_SHOW"))
            fmt::print("shadow {}: {:.3f} of {:.3f} to {:.3f} of {:.3f}, {:.1f} voxels wide\n", to_text(method), dark,
                       truth.front(), bright, truth.back(), wide);
        EXPECT_NEAR(dark, truth.front(), 0.06) << to_text(method);
        EXPECT_NEAR(bright, truth.back(), 0.04) << to_text(method);
        EXPECT_LT(wide, 5) << to_text(method);
    }
}

// Beyond the last nodes is nothing but light, also where these lie in matter.
TEST(LiveSurfaces, AFaceNearTheBorderIsLitAtAnyDistanceOfNodes) {
    constexpr double top = 60.4;  // 3.1 voxels below the border
    const Volume volume = volume_of([](Vec3 p) { return logistic(p.z - top, 0.4); });
    const Look look{{centre.x, centre.y, top + 40}, {0, 0, 1}, {1, 0, 0}, 10};
    for (const int nodes : {1, 2, 4, 8})
        for (const auto& [lighting, right] : {std::pair{matte, 1.0}, {sunny(), under_sunny(1)}}) {
            IlluminationSettings settings = by(Method::visibility);
            settings.visibility.subsample = nodes;
            const double found = brightness(shown(volume, look, settings, skin(), lighting));
            if (std::getenv("CHIARO_SHOW")) fmt::print("1:{}: {:.4f} of {:.4f}\n", nodes, found, right);
            EXPECT_NEAR(found / right, 1, 0.01) << nodes << lighting.probe.source;
        }
}

/// What a highlight adds to the picture of a ball: all of it, and the mean normal of what is brighter than half its
/// brightest.
struct Highlight {
    double energy = 0;
    Vec3 normal{0, 0, 0};
};
Highlight highlight_of(const Frame& with, const Frame& without, const Look& look, double radius) {
    std::vector<double> added;
    for (std::size_t i = 1; i < with.rgba.size(); i += 4) added.push_back(with.rgba[i] - without.rgba[i]);
    std::vector<double> sorted = added;
    std::sort(sorted.begin(), sorted.end());
    const double half = sorted[sorted.size() - 8] / 2;
    Highlight found;
    for (std::size_t i = 0; i < added.size(); ++i) {
        found.energy += added[i];
        const auto across = [&](std::size_t pixel) {
            return (2 * (double(pixel) + 0.5) / look.pixels - 1) * look.half_width / radius;
        };
        const double x = across(i % std::size_t(look.pixels)), y = across(i / std::size_t(look.pixels));
        if (added[i] > half && std::hypot(x, y) < 1)
            found.normal = found.normal + added[i] * Vec3{x, y, std::sqrt(1 - x * x - y * y)};
    }
    found.normal = normalized(found.normal);
    return found;
}

TEST(LiveSurfaces, HighlightsAreWhereTheReferenceHasThem) {
    constexpr double radius = 22.37;
    const Volume volume = ball(0.8, radius);
    const Look look{centre + Vec3{0, -40, 0}, {0, -1, 0}, {1, 0, 0}, radius, 48};
    using Probes = std::vector<std::string>;
    for (const std::string& probe :
         std::getenv("CHIARO_SHOW") ? Probes{"white", "sky", "studio", "windows"} : Probes{"studio"}) {
        const Lighting dull{.specular = 0, .probe = {.source = probe}, .loaded_probe = builtin_probe(probe)};
        Lighting shining = dull;
        shining.specular = 0.3;
        const PathOptions once{.bounces = 0, .surfaces = true};
        const Highlight truth = highlight_of(seen(volume, look, once, 512, skin(), shining),
                                             seen(volume, look, once, 512, skin(), dull), look, radius);
        for (const Method method : live) {
            const Highlight found = highlight_of(shown(volume, look, by(method), skin(), shining),
                                                 shown(volume, look, by(method), skin(), dull), look, radius);
            const double degrees = std::acos(std::min(dot(found.normal, truth.normal), 1.0)) * 180 / pi;
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("highlight {} {}: {:.3f} of the energy, {:.1f} degrees away\n", to_text(method), probe,
                           found.energy / truth.energy, degrees);
            if (probe != "studio") continue;
            EXPECT_LT(degrees, 3) << to_text(method) << probe;
            EXPECT_NEAR(found.energy / truth.energy, 1, 0.15) << to_text(method) << probe;
        }
    }
}

// Occlusion asks each sample alone where a surface is, so that the order of samples does not matter.
TEST(LiveSurfaces, OcclusionIsTheSameInEitherOrder) {
    const Volume volume = ball(0.8, 22.37);
    for (const TransferFunction& tf : {skin(), skin(60, 400)}) {
        const auto in_order = [&](Compositing order) {
            RaySettings rays{.compositing = order};
            rays.early_termination = 0;
            return shown(volume, at_ball(22.37), by(Method::spao), tf, matte, {}, rays);
        };
        const Frame forwards = in_order(Compositing::front_to_back), backwards = in_order(Compositing::back_to_front);
        double worst = 0;
        for (std::size_t i = 0; i < forwards.rgba.size(); ++i)
            worst = std::max(worst, double(std::abs(forwards.rgba[i] - backwards.rgba[i])));
        EXPECT_LT(worst, 1e-4);
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
