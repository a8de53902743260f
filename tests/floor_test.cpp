// The floor: where it lies, the light on it against closed forms, and pictures against the reference.
#include <chiaro/compare.h>
#include <fmt/format.h>

#include "illumination/floor/floor_light.h"
#include "illumination/probe/data.h"
#include "surface_subject.h"
#include "tool_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr double radius = 20;

Medium medium_of(const Volume& volume, const Shape& shape = {}) {
    return classify(upload(tested_device(), volume), skin(), shape);
}

std::shared_ptr<const LitFloor> lit_floor(const Medium& medium, const Lighting& lighting, FloorShadow shadow) {
    const FloorLight light;
    Progress progress;
    return light.light(tested_device(), medium.data(), lighting, {0, 0, 1}, {.shadow = shadow}, progress);
}

/// Of a frame of a ball on the floor.
Frame picture(const IlluminationSettings& settings, const Lighting& lighting, int threads = 2) {
    const Device device = tested_device().has_gpu() ? tested_device() : Device::cpu(threads);
    const Volume volume = ball(0.8, radius);
    const Medium medium = classify(upload(device, volume), skin(), {});
    CameraSettings camera;
    camera.elevation_deg = 30;
    camera.fov_deg = 45;
    const Camera seen = make_camera(camera, volume.geometry, volume.dimensions);
    Lighting light = lighting;
    light.probe_up = seen.orbit_up;
    Frame frame(96, 72);
    Progress progress;
    if (settings.method == Method::reference) {
        trace_paths(device, medium, light, seen, {}, settings, frame, progress);
        return frame;
    }
    IlluminationField field;
    illuminate(
        device, medium, Prepared(), light, settings, [&](IlluminationField finer) { field = std::move(finer); },
        progress);
    raycast(device, medium, field, light, seen, {}, frame, progress);
    return frame;
}

Lighting over_floor(const std::string& probe, double albedo = 0.5) {
    Lighting lighting = matte;
    lighting.loaded_probe = builtin_probe(probe);
    lighting.floor = {true, albedo};
    return lighting;
}

/// RMS of the differences of means over 8 × 8 pixels, over the mean of `b`.
double block_error(const Frame& a, const Frame& b) {
    double squares = 0, sum = 0;
    int blocks = 0;
    for (int y = 0; y < a.height; y += 8)
        for (int x = 0; x < a.width; x += 8) {
            double of_a[4] = {}, of_b[4] = {};
            for (int i = 0; i < 64; ++i)
                for (int c = 0; c < 4; ++c) {
                    const std::size_t at = 4 * (std::size_t(y + i / 8) * std::size_t(a.width) + std::size_t(x + i % 8));
                    of_a[c] += a.rgba[at + std::size_t(c)] / 64, of_b[c] += b.rgba[at + std::size_t(c)] / 64;
                }
            if (of_b[3] < 0.5) continue;
            ++blocks;
            for (int c = 0; c < 3; ++c) squares += (of_a[c] - of_b[c]) * (of_a[c] - of_b[c]) / 3, sum += of_b[c] / 3;
        }
    return std::sqrt(squares / blocks) / (sum / blocks);
}

}  // namespace

class FloorTool : public ToolTest {};

TEST(Floor, LiesUnderTheLowestVoxel) {
    const Volume volume = ball(0.8, radius);
    for (const Vec3 up : {Vec3{0, 0, 1}, {0, -1, 0}, {0.6, 0, 0.8}}) {
        const auto floor = find_floor(medium_of(volume).data(), up);
        ASSERT_TRUE(floor);
        EXPECT_NEAR(floor->height_mm, dot(up, centre) - radius, 0.6);
        EXPECT_NEAR(length(floor->centre - (centre + (floor->height_mm - dot(up, centre)) * up)), 0, 2.5);
        EXPECT_GT(floor->radius_mm, radius);
        EXPECT_LT(floor->radius_mm, 2 * radius);
        const kernel::FloorView view = view_of(*floor, volume.geometry);
        const kernel::Vec3<float> under(float(floor->centre.x), float(floor->centre.y), float(floor->centre.z));
        EXPECT_NEAR(view.height(under), 0, 1e-4);
        EXPECT_NEAR(view.u(under), 0, 1e-5);
    }
    Shape cut;
    cut.clip.planes = {{{0, 0, -1}, -centre.z}};  // keeps the upper half
    EXPECT_NEAR(find_floor(medium_of(volume, cut).data(), {0, 0, 1})->height_mm, centre.z, 1);
    Shape iso;
    iso.mode = Mode::iso;
    iso.iso = {{.value = 100}};
    EXPECT_NEAR(find_floor(medium_of(volume, iso).data(), {0, 0, 1})->height_mm, centre.z - radius, 0.3);
    EXPECT_FALSE(find_floor(medium_of(volume_of([](Vec3) { return 0.0; })).data(), {0, 0, 1}));
}

// A ball that lies on the floor, seen from a place of it x away: of even light it takes (R/d)² cos θ = R³ / (x² +
// R²)^1.5.
TEST(Floor, ABallTakesItsShareOfAnEvenSky) {
    const Medium medium = medium_of(ball(0.4, radius));
    const auto lit = lit_floor(medium, matte, FloorShadow::white);
    const double radius_mm = find_floor(medium.data(), {0, 0, 1})->radius_mm;
    double squares = 0, worst = 0;
    for (int i = 0; i < lit->edge; ++i) {
        const double x = radius_mm * kernel::FloorView::end * (2.0 * i / (lit->edge - 1) - 1);
        const double truth = 1 - std::pow(radius, 3) / std::pow(x * x + radius * radius, 1.5);
        const double off = lit->light[std::size_t(lit->edge / 2) * std::size_t(lit->edge) + std::size_t(i)] - truth;
        if (std::getenv("CHIARO_SHOW") && i % 8 == 0) fmt::print("{:.2f} {:.3f} {:.3f}\n", x, truth, truth + off);
        squares += off * off / lit->edge, worst = std::max(worst, std::abs(off));
    }
    if (std::getenv("CHIARO_SHOW")) fmt::print("even sky: RMS {:.4f}, worst {:.4f}\n", std::sqrt(squares), worst);
    EXPECT_LT(std::sqrt(squares), 0.03);
    EXPECT_LT(worst, 0.09);
}

TEST(Floor, AnOpenOneIsAnOpenPlane) {
    const Medium medium = medium_of(ball(0.8, radius));
    for (const char* name : {"white", "sky", "studio", "windows"}) {
        Lighting lighting = over_floor(name);
        const LambertTable::Entry entry = lighting.loaded_probe.data().lambert().at({0, 0, 1});
        lighting.strength = 0;
        const auto lit = lit_floor(medium, lighting, FloorShadow::probe);
        const std::size_t points = std::size_t(lit->edge) * std::size_t(lit->edge);
        for (std::size_t c = 0; c < 3; ++c) {
            const double truth = std::sqrt(4 * std::numbers::pi) * entry[c][0] / std::numbers::pi;  // V_00 of open sky
            EXPECT_NEAR(lit->light[c * points], truth, 0.02 * truth) << name << c;
            // What it reflects is what comes from below.
            const ProbeImage& below = above_floor(lighting).loaded_probe.data().image;
            EXPECT_NEAR(below.rgb[below.rgb.size() - 3 + c], 0.5 * truth, 0.02 * truth) << name << c;
        }
    }
}

TEST(Floor, LiveIsTheReference) {
    for (const auto& [probe, method] : {std::pair{"white", Method::transport}, {"studio", Method::visibility}}) {
        const Lighting lighting = over_floor(probe);
        IlluminationSettings settings{.method = Method::reference};
        settings.reference.rays = 64;
        if (method == Method::visibility) settings.scattering.bounces.most = 0;
        const double error = block_error(picture({.method = method}, lighting), picture(settings, lighting));
        if (std::getenv("CHIARO_SHOW")) fmt::print("{} {}: {:.3f}\n", probe, to_text(method), error);
        EXPECT_LT(error, 0.05) << probe << to_text(method);
    }
}

// Where nothing absorbs light, all is as bright as the sky.
TEST(Floor, AFurnaceStaysWhite) {
    IlluminationSettings settings{.method = Method::reference};
    settings.reference.rays = 64;
    settings.scattering.albedo_max = 1;
    const Frame frame = picture(settings, over_floor("white", 1));
    double floor = 0, share = 0;
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4)
        if (frame.rgba[i] == frame.rgba[i + 2] && i / 4 % std::size_t(frame.width) < 20)
            floor += frame.rgba[i], share += frame.rgba[i + 3];
    ASSERT_GT(share, 20);
    EXPECT_LT(floor / share, 1.002);
    EXPECT_GT(floor / share, 0.9);  // the ball reflects four fifths
}

TEST(Floor, ThreadsAndMethodsThatKnowNoProbe) {
    const Lighting lighting = over_floor("studio");
    EXPECT_TRUE(picture({.method = Method::visibility}, lighting, 1).rgba ==
                picture({.method = Method::visibility}, lighting, 2).rgba);
    const Frame none = picture({.method = Method::none}, lighting), spao = picture({.method = Method::spao}, lighting);
    const std::size_t corner = 4 * std::size_t(96) * 71;
    EXPECT_NEAR(none.rgba[corner] / none.rgba[corner + 3], 0.5, 1e-5);  // as it is
    EXPECT_LT(spao.rgba[corner + 4 * 48], 0.95f * none.rgba[corner + 4 * 48]);
}

TEST_F(FloorTool, IsRefusedWhereNothingIsLit) {
    const Said refused = tool("render sample:ball:16 --floor --mode mip --size 8x6 -o a.png");
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("--floor has no meaning with --mode mip"), std::string::npos) << refused.err;
    EXPECT_EQ(files(), "");
    EXPECT_EQ(tool("render sample:ball:16 --floor --floor-albedo .7 --lighting visibility --size 48x36 -o a.png").code,
              0);
    EXPECT_EQ(tool("render --scene a.png -o b.png").code, 0);
    EXPECT_TRUE(read_png(folder / "a.png").pixels == read_png(folder / "b.png").pixels);
}
