// Labels in pictures: borders, what is hidden and thinned and tinted, and that light and paths see the product.
#include <chiaro/error.h>

#include "classify/labels/fields.h"
#include "labelled_case.h"
#include "tool_case.h"
#include "volume/device_view.h"
#include "volume/mixture_view.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Extinction per mm and colour of what is there.
kernel::Rgba matter_at(const Medium& medium, Vec3 p) {
    const auto view = view_of<std::uint8_t>(medium.data().volume.data());
    const kernel::Vec3<float> point = view.clamp(kernel::Vec3<float>{float(p.x), float(p.y), float(p.z)});
    kernel::Rgba m = view.matter_at(view.locate(point, view.voxel(point)));
    for (float* c : {&m.r, &m.g, &m.b}) *c = m.a > 0 ? *c / m.a : 0;
    return m;
}

double length_in(Vec3 v, Vec3 spacing) { return length({v.x * spacing.x, v.y * spacing.y, v.z * spacing.z}); }

}  // namespace

TEST(Labelled, BallsAreShadedSmoothly) {
    for (const double radius : {10.0, 30.0})
        for (const bool cut : {false, true})
            for (const double zoom : {1.0, 4.0}) {
                const Vec3 c{radius + 4.13, radius + 3.79, radius + 4.37};
                const int n = int(2 * radius) + 9;
                Labelled ball({n, n, n},
                              [&](double x, double y, double z) {
                                  if (length(Vec3{x, y, z} - c) > radius) return 0;
                                  return cut && x + 0.4 * y > c.x + 0.4 * c.y ? 2 : 1;
                              },
                              {nothing(false), {.value = 1, .rgb = white}, {.value = 2, .rgb = white}});
                ball.tf = constant(0.9);
                EXPECT_LE(shade_error(ball, c, radius, zoom), 0.04) << radius << " cut " << cut << " zoom " << zoom;
            }
}

TEST(Labelled, ThickSlicesAndCoarserLabelsAreShadedSmoothly) {
    // Slices five times as thick as pixels, and labels of 1.5 mm in voxels of .7 mm.
    for (const bool thick : {true, false}) {
        const double radius = 30;
        const Vec3 spacing = thick ? Vec3{1, 1, 5} : Vec3{0.7, 0.7, 0.7},
                   label_spacing = thick ? spacing : Vec3{1.5, 1.5, 1.5};
        const auto count = [&](double mm) { return int(76 / mm); };
        const Vec3 c{37.3, 36.9, 37.6};
        Labelled ball({count(spacing.x), count(spacing.y), count(spacing.z)}, [](double, double, double) { return 0; },
                      {nothing(false), {.value = 1, .rgb = white}});
        ball.numbers = sampled<std::uint8_t>(
            {count(label_spacing.x), count(label_spacing.y), count(label_spacing.z)},
            [&](double x, double y, double z) {
                return length_in({x - c.x / label_spacing.x, y - c.y / label_spacing.y, z - c.z / label_spacing.z},
                                 label_spacing) <= radius;
            });
        ball.volume.geometry.spacing_mm = spacing, ball.numbers.geometry.spacing_mm = label_spacing;
        ball.tf = constant(0.9);
        EXPECT_LE(shade_error(ball, c, radius, 4), 0.04) << thick;
        EXPECT_LE(shade_error(ball, c, radius, 1), 0.04) << thick;
    }
}

TEST(Labelled, HidesThinsAndTintsExactlyTwoVoxelsFromBorders) {
    // Four slabs along x: not shown, half as opaque and blue, red, and what no structure has.
    Labelled slabs({48, 20, 20}, [](double x, double, double) { return x < 12   ? 1
                                                                       : x < 24 ? 2
                                                                       : x < 36 ? 3
                                                                                : 0; },
                   {nothing(true),
                    {.value = 1, .show = false},
                    {.value = 2, .rgb = blue, .tint = 0.5, .opacity = 0.5},
                    {.value = 3, .rgb = red}});
    const Medium medium = slabs.medium();
    const double kappa = -std::log1p(-0.5);
    for (const double y : {0.0, 7.3, 19.0})
        for (double x = 0; x <= 47; x += 0.25) {
            const kernel::Rgba m = matter_at(medium, {x, y, 10.4});
            const double wanted = x < 11.5 ? 0 : x < 23.5 ? 0.5 : 1;
            const bool is_near = std::abs(x - 11.5) < 2 || std::abs(x - 23.5) < 2 || std::abs(x - 35.5) < 2;
            if (is_near) continue;
            EXPECT_NEAR(m.a, wanted * kappa, 0.002 * kappa) << x;
            if (wanted == 0) continue;
            const double tint = x < 23.5 ? 0.5 : x < 35.5 ? 1 : 0;
            const Rgb color = x < 23.5 ? blue : red;
            EXPECT_NEAR(m.r, 1 - tint + tint * color[0], 0.005) << x;
            EXPECT_NEAR(m.g, 1 - tint + tint * color[1], 0.005) << x;
            EXPECT_NEAR(m.b, 1 - tint + tint * color[2], 0.005) << x;
        }
    // A border lies where it is, and what is cut free has its own colour.
    EXPECT_NEAR(matter_at(medium, {11.5, 9, 9}).a, 0.25 * kappa, 0.02 * kappa);
    EXPECT_NEAR(matter_at(medium, {11.75, 9, 9}).r, 0.5, 0.01);
    EXPECT_NEAR(matter_at(medium, {35.5, 9, 9}).g, 0.5, 0.05);
}

namespace {

/// Mean visibility on either side of a dense slab and of a thin one.
void expect_light_to_see(const Medium& medium) {
    Progress progress;
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        IlluminationSettings settings{.method = method};
        Lighting lighting;
        lighting.loaded_probe = load_probe("sky");
        const ComputedField field = compute_field(tested_device(), medium, Prepared(), lighting, settings, progress);
        const auto values = field.volume.as<float>();
        const auto mean = [&](int from, int to) {
            const auto [nx, ny, nz] = field.volume.dimensions;
            const int components = field.volume.components;
            double sum = 0;
            int count = 0;
            for (int x = from * nx / 48; x < to * nx / 48; ++x, ++count)
                sum += std::abs(double(values[std::size_t(((nz / 2 * ny + ny / 2) * nx + x) * components)]));
            return sum / std::max(count, 1);
        };
        EXPECT_LT(mean(14, 22), 0.8 * mean(26, 34)) << int(method);
    }
}

}  // namespace

TEST(Labelled, ATransferFunctionOfALabelsOwnHoldsWithinIt) {
    const auto own = [](double opacity, Rgb rgb) {
        TransferFunction tf;
        tf.rgb_space = RgbSpace::linear;
        tf.points = {{0, rgb, opacity}, {255, rgb, opacity}};
        return std::optional(tf);
    };
    Labelled slabs({48, 20, 20}, [](double x, double, double) { return x < 12   ? 1
                                                                       : x < 24 ? 2
                                                                       : x < 36 ? 3
                                                                                : 0; },
                   {nothing(true),
                    {.value = 1, .show = false},
                    {.value = 2, .tint = 0, .transfer = own(0.8, {0.2, 0.4, 0.6})},
                    {.value = 3, .tint = 0, .opacity = 0.5, .transfer = own(0.1, {1, 0, 0})}});
    const Medium medium = slabs.medium();
    const auto kappa = [](double opacity) { return -std::log1p(-opacity); };
    for (double x = 0; x <= 47; x += 0.25) {
        if (std::abs(x - 11.5) < 2 || std::abs(x - 23.5) < 2 || std::abs(x - 35.5) < 2) continue;
        const kernel::Rgba m = matter_at(medium, {x, 7.3, 10.4});
        const double wanted = x < 12 ? 0 : x < 24 ? kappa(0.8) : x < 36 ? 0.5 * kappa(0.1) : kappa(0.5);
        EXPECT_NEAR(m.a, wanted, 0.004 * kappa(0.8)) << x;
        if (x > 13) EXPECT_NEAR(m.r, x < 24 ? 0.2 : 1, 0.005) << x;
        if (x > 13) EXPECT_NEAR(m.g, x < 24 ? 0.4 : x < 36 ? 0 : 1, 0.005) << x;
    }
    // What is cut free is by its own function up to its border, where half of it is left; what is hidden counts as half
    // as opaque, as the thinnest label is.
    EXPECT_NEAR(matter_at(medium, {11.5, 9, 9}).a, 0.5 * 0.75 * kappa(0.8), 0.03 * kappa(0.8));
    EXPECT_NEAR(matter_at(medium, {11.5, 9, 9}).r, 0.2, 0.01);
    const auto camera = make_camera({}, slabs.volume.geometry, slabs.volume.dimensions);
    const Frame skipped = slabs.picture(camera, {}, {.skip_empty = true}, 40),
                all = slabs.picture(camera, {}, {.skip_empty = false}, 40);
    EXPECT_EQ(skipped.rgba, all.rgba);
    expect_light_to_see(medium);

    std::vector<Label> many{nothing(true)};
    for (std::uint32_t v = 1; v < 9; ++v) many.push_back({.value = v, .transfer = own(v / 10.0, red)});
    slabs.table = many;
    slabs.numbers = sampled<std::uint8_t>({48, 20, 20}, [](double x, double, double) { return int(x) % 9; });
    EXPECT_THROW(slabs.medium(), Error);
    slabs.table.back().transfer = slabs.table[1].transfer;  // as another's
    EXPECT_NO_THROW(slabs.medium());
}

TEST(Labelled, AllThreadsMakeTheSame) {
    const Volume numbers =
        sampled<std::uint8_t>({70, 65, 40}, [](double x, double y, double z) { return int(shells(x, y, z, 70)) / 40; });
    std::vector<Label> table{nothing(true)};
    for (std::uint32_t v = 1; v < 8; ++v)
        table.push_back({.value = v, .rgb = {v / 8.0, 1 - v / 8.0, 0.5}, .opacity = v % 2 ? 1 : 0.25, .show = v != 3});
    const LabelVolume labels = labels_of(numbers, table);
    Progress progress;
    const LabelFields one = make_label_fields(labels, labels.labels, ColorMode::linear, 1, progress),
                      four = make_label_fields(labels, labels.labels, ColorMode::linear, 4, progress);
    for (const auto field : {&LabelFields::distance, &LabelFields::share, &LabelFields::tint}) {
        ASSERT_GT((one.*field).size(), 0);
        EXPECT_EQ(std::memcmp((one.*field).data(), (four.*field).data(), (one.*field).size()), 0);
    }
}

TEST(Labelled, ManyLabelsAtAPlaceAreMeans) {
    Labelled dust({34, 33, 9}, [](double x, double y, double z) { return int(x * 7 + y * 3 + z * 5) % 120; }, {});
    for (std::uint32_t v = 0; v < 120; ++v) dust.table.push_back({.value = v, .rgb = {v / 119.0, 0, 0}});
    const kernel::Rgba m = matter_at(dust.medium(), {17, 17, 4});
    EXPECT_GT(m.r, 0.05);
    EXPECT_NEAR(m.g, 0, 0.01);
    EXPECT_NEAR(m.a, -std::log1p(-0.5), 1e-4);
}

TEST(Labelled, SkippingEmptyCellsChangesNothing) {
    Labelled slabs({40, 40, 40}, [](double x, double y, double) { return x < 12 || y > 25 ? 1 : 2; },
                   {nothing(true), {.value = 1, .show = false}, {.value = 2, .rgb = red}});
    const Medium medium = slabs.medium();
    EXPECT_LT(medium.occupied_fraction(), 0.6);
    const Camera camera = make_camera({}, slabs.volume.geometry, slabs.volume.dimensions);
    const Frame skipped = slabs.picture(camera, {}, {.skip_empty = true}, 60),
                sampled = slabs.picture(camera, {}, {.skip_empty = false}, 60);
    EXPECT_EQ(skipped.rgba, sampled.rgba);
    EXPECT_GT(mean_alpha(sampled), 0.05);
}

/// Hidden: as if it were not there, for every light.
TEST(Labelled, LightSeesWhatIsLeft) {
    constexpr int n = 32;
    const auto number = [](double x, double y, double z) {
        return z > 22 ? 1 : length(Vec3{x, y, z} - Vec3{15.5, 15.5, 10}) < 7 ? 2 : 0;
    };
    const std::vector<Label> table{nothing(false), {.value = 1, .show = false}, {.value = 2, .rgb = white}};
    Labelled hidden({n, n, n}, number, table);
    hidden.tf = constant(0.6);
    // The same with the values of nothing where something is hidden, by labels that show all.
    Labelled removed({n, n, n}, [](double, double, double) { return 1; }, {nothing(true), {.value = 1, .rgb = white}});
    removed.volume = sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) {
        return std::clamp(100 * (7.5 - length(Vec3{x, y, z} - Vec3{15.5, 15.5, 10})), 0.0, 100.0);
    });
    removed.tf.points = {{0, white, 0}, {100, white, 0.6}};
    const Camera camera = make_camera({}, hidden.volume.geometry, hidden.volume.dimensions);
    const auto lit = [&](const Labelled& of, Method method) {
        Lighting lighting{.shading = Shading::none};
        lighting.probe_up = camera.orbit_up;
        if (method != Method::spao) lighting.loaded_probe = load_probe("white");
        Progress progress;
        const Medium medium = of.medium();
        IlluminationSettings settings{.method = method};
        IlluminationField field;
        illuminate(
            tested_device(), medium, Prepared(), lighting, settings,
            [&](IlluminationField finer) { field = std::move(finer); }, progress);
        Frame frame(48, 48);
        raycast(tested_device(), medium, field, lighting, camera, {}, frame, progress);
        double light = 0;
        for (std::size_t p = 0; p < frame.rgba.size(); p += 4) light += frame.rgba[p];
        return light / (48 * 48);
    };
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        const double a = lit(hidden, method), b = lit(removed, method);
        EXPECT_NEAR(a, b, 0.06 * b) << to_text(method);
        EXPECT_GT(b, 0.01) << to_text(method);
    }
}

TEST(Labelled, WhatKnowsNoLabelsSaysSo) {
    Labelled slab({12, 12, 12}, [](double x, double, double) { return x < 6; }, {nothing(false), {.value = 1}});
    slab.shape.mode = Mode::mean;
    try {
        slab.medium();
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_TRUE(
            std::string(error.what()).starts_with("labels: they go with --mode dvr, iso, additive, mip and minip"))
            << error.what();
    }
}

TEST_F(ToolTest, DrawsLabels) {
    write("table.json", R"({"labels": [{"value": 0, "show": false}, {"value": 200, "rgb": [0, 1, 0]}]})");
    const std::string small = " --size 40x30 --lighting none --quiet";
    EXPECT_EQ(tool("render sample:ball:24 --labels sample:cornell:24 --label-table table.json -o a.png" + small).err,
              "");
    EXPECT_EQ(tool("render --labels sample:cornell:24 --label-table table.json -o b.png" + small).err, "");
    EXPECT_EQ(tool("render --scene a.png -o c.png --quiet").err, "");
    EXPECT_EQ(read("a.png"), read("c.png"));
    EXPECT_EQ(tool("render sample:ball:24 -o plain.png" + small).code, 0);
    EXPECT_NE(read("a.png").size(), read("plain.png").size());
    const Said table = tool("render sample:ball:24 --label-table table.json -o d.png" + small);
    EXPECT_EQ(table.code, 2);
    EXPECT_NE(table.err.find("a table (--label-table) needs labels"), std::string::npos) << table.err;
    const Said histogram = tool("render --labels sample:cornell:24 -o d.png --lighting histogram --size 40x30 --quiet");
    EXPECT_EQ(histogram.code, 2) << histogram.err;
    const Said missing = tool("render sample:ball:24 --labels nowhere.nrrd -o d.png" + small);
    EXPECT_EQ(missing.code, 3);
    EXPECT_EQ(files(), "a.png b.png c.png plain.png table.json");
}
