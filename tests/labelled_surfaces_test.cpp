// Isosurfaces of volumes in which labels lie: cut at smooth borders, tinted, and lit as if what is hidden were not
// there.
#include <chiaro/error.h>
#include <chiaro/pick.h>

#include "labelled_case.h"
#include "tool_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Values fall along z from 250 to 0, so the surface of 100 is a plane; three labels side by side along x.
Labelled plane(std::vector<Label> table, double opacity = 1) {
    Labelled made(
        {36, 20, 26}, [](double x, double, double) { return x < 12   ? 1
                                                            : x < 24 ? 2
                                                                     : 3; }, std::move(table));
    made.volume = sampled<std::uint8_t>({36, 20, 26}, [](double, double, double z) { return 250 - 10 * z; });
    made.shape.mode = Mode::iso;
    made.shape.iso = {{.value = 100, .color = white, .opacity = opacity}};
    return made;
}
constexpr double plane_z = 15;

/// From above the plane, 36 x 20 pixels: one a voxel.
const Camera from_above{.eye = {17.5, 9.5, 100},
                        .forward = {0, 0, -1},
                        .right = {1, 0, 0},
                        .up = {0, 1, 0},
                        .projection = Projection::orthographic,
                        .half_height = 10};
Frame picture(const Labelled& of, const RaySettings& rays = {}) {
    Frame frame(36, 20);
    Progress progress;
    raycast(tested_device(), of.medium(), IlluminationField(), {.shading = Shading::none}, from_above, rays, frame,
            progress);
    return frame;
}
std::array<float, 4> pixel(const Frame& frame, int x) {
    const float* p = &frame.rgba[std::size_t(4 * (10 * frame.width + x))];
    return {p[0], p[1], p[2], p[3]};
}

}  // namespace

TEST(LabelledSurfaces, LabelsThatChangeNothingAreTheSamePictureBitForBit) {
    Labelled ball = plane({nothing(true), {.value = 1, .tint = 0}, {.value = 2, .tint = 0}, {.value = 3, .tint = 0}});
    ball.volume = sampled<std::uint8_t>({36, 20, 26}, [](double x, double y, double z) { return shells(x, y, z, 26); });
    const Camera camera = make_camera({}, ball.volume.geometry, ball.volume.dimensions);
    Frame plain(50, 40);
    Progress progress;
    raycast(tested_device(), classify(upload(tested_device(), ball.volume), ball.tf, ball.shape), IlluminationField(),
            {}, camera, {}, plain, progress);
    EXPECT_GT(mean_alpha(plain), 0.05);
    Frame labelled(50, 40);
    raycast(tested_device(), ball.medium(), IlluminationField(), {}, camera, {}, labelled, progress);
    EXPECT_EQ(plain.rgba, labelled.rgba);
}

TEST(LabelledSurfaces, AreTintedAndCutAtBorders) {
    const Labelled three = plane(
        {nothing(true), {.value = 1, .show = false}, {.value = 2, .rgb = red}, {.value = 3, .rgb = blue, .tint = 0.5}});
    for (const bool skips : {true, false}) {
        const Frame frame = picture(three, {.skip_empty = skips});
        for (int x = 0; x < 35; ++x) {
            const auto [r, g, b, a] = pixel(frame, x);
            EXPECT_EQ(a, x < 12 ? 0 : 1) << x;  // the border lies at 11.5
            if (x < 12 || std::abs(x - 23.5) < 2) continue;
            EXPECT_NEAR(r, x < 24 ? 1 : 0.5, 0.01) << x;
            EXPECT_NEAR(g, x < 24 ? 0 : 0.5, 0.01) << x;
            EXPECT_NEAR(b, x < 24 ? 0 : 1, 0.01) << x;
        }
    }
    EXPECT_EQ(picture(three, {.skip_empty = true}).rgba, picture(three, {.skip_empty = false}).rgba);
    // Seen from where it is hidden, what is left is closed: its wall is the border.
    const Medium medium = three.medium();
    const Camera along_x{.eye = {-100, 9.5, 10},
                         .forward = {1, 0, 0},
                         .right = {0, 1, 0},
                         .up = {0, 0, 1},
                         .projection = Projection::orthographic,
                         .half_height = 13};
    const auto wall = pick(medium, along_x, {}, 20, 26, 10, 13);
    ASSERT_TRUE(wall);
    EXPECT_NEAR(wall->p_voxel.x, 11.5, 0.05);
    EXPECT_NEAR(wall->rgb[0], 1, 0.01);
    const auto top = pick(medium, from_above, {}, 36, 20, 18.5, 10);
    ASSERT_TRUE(top);
    EXPECT_NEAR(top->p_voxel.z, plane_z, 0.01);
    EXPECT_FALSE(pick(medium, from_above, {}, 36, 20, 5.5, 10));
}

TEST(LabelledSurfaces, SeveralAreCutTogetherInBothOrders) {
    Labelled two =
        plane({nothing(true), {.value = 1, .show = false}, {.value = 2, .tint = 0}, {.value = 3, .rgb = red}}, 0.5);
    two.shape.iso.push_back({.value = 180, .color = Rgb{0, 1, 0}, .opacity = 0.5});
    const Frame forwards = picture(two), backwards = picture(two, {.compositing = Compositing::back_to_front});
    EXPECT_LE(difference(forwards, backwards, 0).max, 1e-6);
    const auto both = pixel(forwards, 18);
    EXPECT_NEAR(both[3], 0.75, 1e-5);
    EXPECT_NEAR(both[0], 0.5, 0.01);
    EXPECT_NEAR(both[1], 0.75, 0.01);
    EXPECT_NEAR(pixel(forwards, 30)[0], 0.75, 0.01);
    EXPECT_EQ(pixel(forwards, 5)[3], 0);
}

TEST(LabelledSurfaces, WhatIsCutFreeIsShadedSmoothly) {
    for (const double radius : {10.0, 30.0})
        for (const double zoom : {1.0, 4.0}) {
            const Vec3 c{radius + 4.13, radius + 3.79, radius + 4.37};
            const int n = int(2 * radius) + 9;
            Labelled ball({n, n, n},
                          [&](double x, double y, double z) {
                              return length(Vec3{x, y, z} - c) <= radius;
                          },
                          {nothing(false), {.value = 1, .rgb = white}});
            ball.shape.mode = Mode::iso;
            ball.shape.iso = {{.value = 50, .color = white}};
            EXPECT_LE(shade_error(ball, c, radius, zoom), 0.04) << radius << " zoom " << zoom;
        }
}

namespace {

/// Light and colour of a ball over a wall, hidden labels before it; or of the same without them.
Rgb mean_light(const Labelled& of, Method method) {
    Lighting lighting{.shading = Shading::none};
    const Camera camera = make_camera({}, of.volume.geometry, of.volume.dimensions);
    lighting.probe_up = camera.orbit_up;
    if (method != Method::spao) lighting.loaded_probe = load_probe("white");
    Progress progress;
    IlluminationSettings settings{.method = method};
    settings.reference.rays = 64;
    settings.scattering.bounces.most = 3;
    const Medium medium = of.medium();
    Frame frame(48, 48);
    if (method == Method::reference) {
        trace_paths(tested_device(), medium, lighting, camera, {}, settings, frame, progress);
    } else {
        IlluminationField field;
        illuminate(
            tested_device(), medium, Prepared(), lighting, settings,
            [&](IlluminationField finer) { field = std::move(finer); }, progress);
        raycast(tested_device(), medium, field, lighting, camera, {}, frame, progress);
    }
    Rgb sum{};
    for (std::size_t p = 0; p < frame.rgba.size(); p += 4)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += frame.rgba[p + c] / (48 * 48);
    return sum;
}

}  // namespace

TEST(LabelledSurfaces, LightAndPathsSeeWhatIsLeft) {
    constexpr int n = 32;
    const auto depth = [](double x, double y, double z) { return 6 - length(Vec3{x, y, z} - Vec3{15.5, 15.5, 14}); };
    const auto number = [&](double x, double y, double z) {
        return z > 22 ? 1 : z < 4 ? 3 : depth(x, y, z) > 0 ? 2 : 0;
    };
    const Label wall{.value = 3, .rgb = red}, ball{.value = 2, .rgb = {0.9, 0.9, 0.2}};
    Labelled hidden({n, n, n}, number, {nothing(false), {.value = 1, .show = false}, ball, wall});
    hidden.shape.mode = Mode::iso;
    hidden.shape.iso = {{.value = 50, .color = white}};
    // The same surfaces in values, of labels that show all.
    Labelled removed({n, n, n}, [](double, double, double z) { return z < 6 ? 3 : 2; }, {nothing(true), ball, wall});
    removed.shape = hidden.shape;
    removed.volume = sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) {
        return std::clamp(50 + 20 * std::max(depth(x, y, z), 3.5 - z), 0.0, 100.0);
    });
    for (const Method method : {Method::spao, Method::visibility, Method::transport, Method::reference}) {
        const Rgb a = mean_light(hidden, method), b = mean_light(removed, method);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 0.06 * b[0]) << to_text(method) << " " << c;
        EXPECT_GT(b[0], 0.05) << to_text(method);
        EXPECT_LT(b[2], 0.8 * b[0]) << to_text(method);
    }
}

TEST(LabelledSurfaces, PathsAndLiveLightHaveTheSameColours) {
    const Labelled three = plane({nothing(true),
                                  {.value = 1, .show = false},
                                  {.value = 2, .rgb = {0.8, 0.2, 0.1}},
                                  {.value = 3, .rgb = {0.1, 0.3, 0.8}, .tint = 0.5}});
    const Medium medium = three.medium();
    Lighting lighting{.shading = Shading::none};
    lighting.loaded_probe = load_probe("white");
    IlluminationSettings settings{.method = Method::reference};
    settings.reference.rays = 256;
    settings.scattering.bounces.most = 0;
    Progress progress;
    Frame frame(36, 20);
    trace_paths(tested_device(), medium, lighting, from_above, {}, settings, frame, progress);
    const Frame lit = picture(three);  // all the light of a white probe
    for (const int x : {4, 17, 31})
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(pixel(frame, x)[c], pixel(lit, x)[c], 0.03) << x << " " << c;
}

TEST(LabelledSurfaces, WhatHasNoMeaningIsSaid) {
    const auto told = [](const Labelled& of) {
        try {
            of.medium();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage);
            return std::string(error.what());
        }
        return std::string("nothing");
    };
    Labelled thin = plane({nothing(true), {.value = 1, .opacity = 0.5}});
    EXPECT_EQ(told(thin),
              "labels: an opacity between 0 and 1 goes with --mode dvr, additive, mip and minip: an "
              "isosurface has one of its own (--iso VALUE,COLOUR@OPACITY)");
    Labelled all = plane({nothing(true), {.value = 1, .show = false}});
    all.shape.iso[0].value = -5;
    EXPECT_EQ(told(all),
              "labels: every value that a voxel can have lies within the lowest isosurface (--iso), so "
              "nothing can be hidden");
}

TEST_F(ToolTest, DrawsIsosurfacesOfLabels) {
    write("table.json", R"({"labels": [{"value": 0, "show": false}, {"value": 1, "rgb": [0, 1, 0]}]})");
    const std::string small = " --size 40x30 --mode iso --iso 80 --quiet";
    const std::string labelled = "render sample:torso:32 --labels sample:organs:32 --label-table table.json";
    for (const char* lighting : {"none", "visibility --probe sky", "reference --probe sky --reference-rays 4"})
        EXPECT_EQ(tool(labelled + " -o a.png --lighting " + lighting + small).err, "") << lighting;
    EXPECT_EQ(tool("render --scene a.png -o b.png --quiet").err, "");
    EXPECT_EQ(read("a.png"), read("b.png"));
    const Said histogram = tool(labelled + " -o c.png --lighting histogram" + small);
    EXPECT_EQ(histogram.code, 2);
    EXPECT_NE(histogram.err.find("local histograms know no labels"), std::string::npos) << histogram.err;
}
