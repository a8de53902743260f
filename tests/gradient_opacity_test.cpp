// Opacity by gradient, and over value and gradient: closed forms, the same medium for every light, and what is refused.
#include <chiaro/error.h>
#include <chiaro/samples.h>

#include <algorithm>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int n = 24;

/// Values that rise along x by `slope` a voxel; their gradient is slope / spacing data units per mm.
template <class T>
Volume ramp(double slope, Vec3 spacing = {1, 1, 1}) {
    Volume volume = sampled<T>({n, n, n}, [&](double x, double, double) { return 20 + slope * x; });
    volume.geometry.spacing_mm = spacing;
    return volume;
}

/// One grey of opacity .3 a voxel where the ramp is away from the volume's border, whose differences are halved.
TransferFunction middle(double slope) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    const auto at = [&](double x) { return 20 + slope * x; };
    const Rgb grey{0.6, 0.5, 0.4};
    tf.points = {{at(3.9), grey, 0}, {at(4), grey, 0.3}, {at(19), grey, 0.3}, {at(19.1), grey, 0}};
    return tf;
}

double rmse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::pow(double(a.pixels[i]) - b.pixels[i], 2);
    return std::sqrt(sum / double(a.pixels.size()));
}

struct Pictured {
    Volume volume;
    TransferFunction tf;
    double opacity_scale = 1;
    Method method = Method::none;
    bool skip_empty = true;
    int paths = 256;
    std::uint64_t seed = 0;

    Image picture() const {
        Session session(tested_device());
        Progress progress;
        session.show(volume, progress);
        return session.render(scene(), progress);
    }
    Scene scene() const {
        Scene scene;
        scene.transfer.points = tf;
        scene.transfer.opacity_scale = opacity_scale;
        scene.interpolation = Interpolation::linear;
        scene.illumination.method = method;
        scene.illumination.reference.rays = paths;
        scene.illumination.scattering.seed = seed;
        scene.lighting.probe.source = method == Method::none || method == Method::spao ? "" : "sky";
        scene.sampling.skip_empty = skip_empty;
        scene.camera.fit = Fit::volume;
        scene.width = 48, scene.height = 40;
        return scene;
    }
};

/// Alpha of the middle pixel of a look along y, at a value where the ramp is in the middle.
double alpha_along_y(const Volume& volume, const TransferFunction& tf, Interpolation interpolation) {
    const Medium medium = classify(upload(tested_device(), volume), tf, {.interpolation = interpolation});
    const Vec3 centre = volume.geometry.world_from_voxel({(n - 1) / 2.0, (n - 1) / 2.0, (n - 1) / 2.0});
    Frame frame(1, 1);
    Progress progress;
    raycast(tested_device(), medium, IlluminationField(), {.shading = Shading::none}, along_y(centre.x, centre.z),
            {.step_voxels = 0.25, .early_termination = 0}, frame, progress);
    return frame.rgba[3];
}

}  // namespace

TEST(GradientOpacity, IsAFactorOfExtinctionInUnitsPerMillimetre) {
    const auto check = [&](const Volume& volume, double slope, double spacing_x, double spacing_y) {
        const double magnitude = slope / spacing_x;
        for (const double share : {0.0, 0.25, 0.5, 1.0}) {
            TransferFunction tf = middle(slope);
            tf.opacity_unit = 5, tf.opacity_unit_is_mm = true;
            // Around the ramp's own magnitude and nowhere else.
            tf.gradient = {
                {0.8 * magnitude, 1}, {0.95 * magnitude, share}, {1.05 * magnitude, share}, {1.2 * magnitude, 1}};
            const double depth = -std::log1p(-0.3) / 5 * share * (n - 1) * spacing_y;
            // Of splines, too; the medium alone keeps what it needs.
            for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic})
                EXPECT_NEAR(alpha_along_y(volume, tf, interpolation), -std::expm1(-depth), 2e-3)
                    << share << " " << slope << " " << int(interpolation);
        }
    };
    check(ramp<std::uint8_t>(8), 8, 1, 1);
    check(ramp<std::uint16_t>(400, {0.5, 2, 1}), 400, 0.5, 2);
    check(ramp<float>(0.75, {3, 1.5, 0.5}), 0.75, 3, 1.5);
    Volume scaled = ramp<std::int16_t>(16);
    scaled.slope = 0.5, scaled.intercept = 10;  // values 20 + 8 x
    check(scaled, 8, 1, 1);
}

// Colour and opacity on a grid: of one gradient those of its row, whose colours others do not have.
TEST(GradientOpacity, AGridHasColoursOfItsOwn) {
    constexpr double slope = 8, kappa = 0.02;
    GradientGrid grid{.columns = 2, .rows = 3, .value_low = 0, .value_high = 255, .magnitude_high = 2 * slope};
    const auto opacity = [](double of_kappa) { return float(-std::expm1(-of_kappa)); };
    for (const auto& [r, g, b, k] :
         {std::array{1.0, 0.0, 0.0, 3 * kappa}, {0.2, 0.4, 0.6, kappa}, {0.0, 0.0, 1.0, 0.0}})
        grid.rgba.insert(grid.rgba.end(), 2, {float(r), float(g), float(b), opacity(k)});
    TransferFunction tf = over_gradient(grid);
    tf.rgb_space = RgbSpace::linear;
    EXPECT_NEAR(tf.points[0].opacity, opacity(3 * kappa), 1e-6);
    EXPECT_NEAR(extinction_factor(tf, 100, slope), 1.0 / 3, 1e-6);
    EXPECT_NEAR(extinction_factor(tf, 100, 0), 1, 1e-6);
    const auto pixel = [&](const Volume& volume) {
        const Medium medium = classify(upload(tested_device(), volume), tf, {});
        Frame frame(1, 1);
        Progress progress;
        raycast(tested_device(), medium, IlluminationField(), {.shading = Shading::none}, along_y(11.5, 11.5),
                {.early_termination = 0}, frame, progress);
        return std::array{frame.rgba[0], frame.rgba[1], frame.rgba[2], frame.rgba[3]};
    };
    const auto steep = pixel(ramp<std::uint8_t>(slope)), flat = pixel(ramp<std::uint8_t>(0));
    // Rows of the table are 1/500 of the grid apart.
    const double alpha = -std::expm1(-kappa * (n - 1)), of_flat = -std::expm1(-3 * kappa * (n - 1));
    EXPECT_NEAR(steep[3], alpha, 3e-3);
    EXPECT_NEAR(flat[3], of_flat, 3e-3);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(steep[c], alpha * (0.2 + 0.2 * double(c)), 3e-3);
    EXPECT_NEAR(flat[0], of_flat, 3e-3);
    EXPECT_NEAR(flat[2], 0, 3e-3);
    tf.grid.rgba.pop_back();
    EXPECT_THROW(validate(tf), Error);
}

TEST(GradientOpacity, EveryLightSeesTheProduct) {
    // All of what is seen has one gradient, and so what is seen by it is thinner matter.
    TransferFunction by_gradient = middle(8);
    by_gradient.gradient = {{4, 1}, {6, 0.25}};
    TransferFunction by_widget = middle(8);
    by_widget.widgets = {{WidgetShape::rectangle, 0, 300, 6, 10, 0.25}, {WidgetShape::ellipse, 0, 30, 60, 100, 1}};
    for (const Method method : {Method::none, Method::spao, Method::visibility, Method::transport, Method::reference}) {
        const Image thin = Pictured{ramp<std::uint8_t>(8), middle(8), 0.25, method}.picture();
        const Image whole = Pictured{ramp<std::uint8_t>(8), middle(8), 1, method}.picture();
        // Of paths other numbers are drawn: by the noise of two pictures.
        double most = 1;
        if (method == Method::reference)
            most = 1.2 * rmse(thin, Pictured{ramp<std::uint8_t>(8), middle(8), 0.25, method, true, 256, 7}.picture());
        for (const TransferFunction& tf : {by_gradient, by_widget}) {
            const Image seen = Pictured{ramp<std::uint8_t>(8), tf, 1, method}.picture();
            EXPECT_LE(rmse(seen, thin), most) << int(method);
            EXPECT_GT(rmse(seen, whole), 4 * most) << int(method);
        }
    }
}

TEST(GradientOpacity, SkippingChangesNothing) {
    for (const bool both : {false, true}) {
        TransferFunction tf = two_materials();
        tf.gradient = {{6, 0}, {12, 1}};
        if (both)
            tf.widgets = {{WidgetShape::triangle, 60, 160, 4, 40, 1}, {WidgetShape::ellipse, 150, 240, 2, 30, 0.5}};
        const auto volume = [] {
            return sampled<std::uint8_t>({40, 38, 36},
                                         [](double x, double y, double z) { return shells(x, y, z, 40); });
        };
        Pictured skipping{volume(), tf}, not_skipping{volume(), tf};
        not_skipping.skip_empty = false;
        EXPECT_TRUE(skipping.picture().pixels == not_skipping.picture().pixels);
    }
    // Within matter that is even nothing rises, and nothing is left.
    const DeviceVolume ball =
        upload(tested_device(), sampled<std::uint8_t>({64, 64, 64}, [](double x, double y, double z) {
                   return 200 / (1 + std::exp(std::hypot(x - 32, y - 32, z - 32) - 26));
               }));
    TransferFunction tf = constant(0.2);
    tf.points.front().value = 50, tf.points.insert(tf.points.begin(), {50, {1, 1, 1}, 0});
    const double all = classify(ball, tf, Shape()).occupied_fraction();
    tf.gradient = {{6, 0}, {12, 1}};
    const double left = classify(ball, tf, Shape()).occupied_fraction();
    EXPECT_LT(left, 0.95 * all);
    EXPECT_GT(left, 0.1 * all);
}

TEST(GradientOpacity, FactorsAreWhatTheFunctionSays) {
    TransferFunction tf = middle(8);
    tf.gradient = {{1, 0.5}, {2, 1}, {2, 0}};
    EXPECT_EQ(extinction_factor(tf, 0, 0), 0.5);
    EXPECT_EQ(extinction_factor(tf, 0, 1.5), 0.75);
    EXPECT_EQ(extinction_factor(tf, 0, 3), 0);
    tf.gradient.clear();
    tf.widgets = {{WidgetShape::rectangle, 10, 20, 1, 2, 0.7}};
    EXPECT_EQ(extinction_factor(tf, 15, 1.5), 0.7);
    EXPECT_EQ(extinction_factor(tf, 15, 2.5), 0);
    EXPECT_EQ(extinction_factor(tf, 9, 1.5), 0);
    tf.widgets[0].shape = WidgetShape::ellipse;
    EXPECT_EQ(extinction_factor(tf, 15, 1.5), 0.7);
    EXPECT_NEAR(extinction_factor(tf, 17.5, 1.5), 0.7 * 0.75, 1e-12);
    EXPECT_EQ(extinction_factor(tf, 10, 1.5), 0);
    tf.widgets[0].shape = WidgetShape::triangle;
    EXPECT_EQ(extinction_factor(tf, 15, 1), 0.7);
    EXPECT_NEAR(extinction_factor(tf, 17.5, 2), 0.7 * 0.5, 1e-12);
    EXPECT_EQ(extinction_factor(tf, 17.5, 1), 0);  // as wide as at half the height
}

/// Of what is passed, how much lies within .08 of the outermost shell of `sample:shells`, and how much of that shell is
/// passed. Matter is what stands out of the background, whose values reach 14.
struct PassedShell {
    double all = 0, of_shell = 0;
    void add(double extinction, bool is_in_shell) {
        all += extinction;
        if (is_in_shell) of_shell += extinction;
    }
};

// A window of values that passes 70 % of the outermost shell passes the flanks of the others, too; a widget leaves out
// what is steep.
TEST(GradientOpacity, AWidgetPassesAShellThatNoWindowDoes) {
    constexpr int size = 256, background = 14;
    Progress progress;
    const Volume volume = make_sample("shells", size, progress);
    TransferFunction tf;
    tf.points = {{background + 0.4, {1, 1, 1}, 0}, {background + 0.6, {1, 1, 1}, 1}};
    tf.widgets = {{WidgetShape::rectangle, 32, 108, 0, 20, 1}};
    std::array<PassedShell, 256> by_value;
    PassedShell by_widget;
    const auto voxels = volume.as<std::uint8_t>();
    const auto at = [&](int x, int y, int z) { return double(voxels[std::size_t((z * size + y) * size + x)]); };
    const auto from_middle = [](int i) { return 2.0 * i / (size - 1) - 1; };
    for (int z = 1; z < size - 1; ++z)
        for (int y = 1; y < size - 1; ++y)
            for (int x = 1; x < size - 1; ++x) {
                const double value = at(x, y, z);
                if (value <= background) continue;
                const Vec3 rise{at(x + 1, y, z) - at(x - 1, y, z), at(x, y + 1, z) - at(x, y - 1, z),
                                at(x, y, z + 1) - at(x, y, z - 1)};
                const bool is_in_shell =
                    std::abs(length(Vec3{from_middle(x), from_middle(y), from_middle(z)}) - 0.82) < 0.08;
                by_value[std::size_t(value)].add(1, is_in_shell);
                by_widget.add(extinction_factor(tf, value, length(rise) / 2), is_in_shell);
            }
    double shell = 0, best_window = 0;
    for (const PassedShell& one : by_value) shell += one.of_shell;
    for (std::size_t low = 0; low < by_value.size(); ++low) {
        PassedShell window;
        for (std::size_t high = low; high < by_value.size(); ++high) {
            window.all += by_value[high].all, window.of_shell += by_value[high].of_shell;
            if (window.of_shell >= 0.7 * shell) best_window = std::max(best_window, window.of_shell / window.all);
        }
    }
    const double kept = by_widget.of_shell / by_widget.all, passed = by_widget.of_shell / shell;
    if (std::getenv("CHIARO_SHOW"))
        std::printf("widget: %.3f of what it passes, %.3f of the shell; best window %.3f\n", kept, passed, best_window);
    EXPECT_GE(kept, 0.9);
    EXPECT_GE(passed, 0.7);
    EXPECT_LT(best_window, 0.77);
}

TEST(GradientOpacity, IsKeptAndMovedWithTheWindow) {
    TransferFunction tf = middle(8);
    tf.gradient = {{1, 0.5}, {2.5, 1}};
    tf.widgets = {{WidgetShape::triangle, 60, 160, 0.5, 4, 0.5}};
    EXPECT_EQ(parse_transfer_function(to_json(tf), "again"), tf);
    const double width = tf.points.back().value - tf.points.front().value;
    const TransferFunction wide = with_window(tf, 0, 2 * width);
    EXPECT_EQ(wide.gradient[1].magnitude, 5);
    EXPECT_EQ(wide.widgets[0].magnitude_high, 8);
    EXPECT_NEAR(wide.widgets[0].value_high - wide.widgets[0].value_low, 200, 1e-9);
    const auto refusal = [](const std::string& more) -> std::string {
        try {
            parse_transfer_function(R"({"points": [{"value": 0, "rgb": [0, 0, 0], "opacity": 1}], )" + more + "}",
                                    "a.json");
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(R"("gradient_opacity": [{"magnitude": -1, "opacity": 1}])"),
              "a.json: transfer function: gradient_opacity[0].magnitude is -1: must be finite and not below 0");
    EXPECT_EQ(refusal(R"("gradient_opacity": [{"magnitude": 1, "opacity": 2}])"),
              "a.json: transfer function: gradient_opacity[0].opacity is 2: must be in [0, 1]");
    EXPECT_NE(refusal(R"("widgets": [{"shape": "star", "value": [0, 1], "magnitude": [0, 1]}])")
                  .find("must be 'rectangle', 'ellipse' or 'triangle'"),
              std::string::npos);
    EXPECT_NE(refusal(R"("widgets": [{"shape": "ellipse", "value": [1, 1], "magnitude": [0, 1]}])").find("must rise"),
              std::string::npos);
}

TEST(GradientOpacity, IsRefusedWhereItHasNoMeaning) {
    TransferFunction tf = middle(8);
    tf.gradient = {{4, 1}, {6, 0.25}};
    const auto refusal = [&](const auto& change) -> std::string {
        Session session(tested_device());
        Progress progress;
        session.show(ramp<std::uint8_t>(8), progress);
        Scene scene = Pictured{{}, tf}.scene();
        change(scene);
        try {
            session.render(scene, progress);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    for (const Classification c : {Classification::pre, Classification::preintegrated})
        EXPECT_NE(refusal([&](Scene& scene) { scene.sampling.classification = c; }).find("goes with post"),
                  std::string::npos);
    EXPECT_NE(refusal([](Scene& scene) { scene.illumination.method = Method::histogram; }).find("no gradients"),
              std::string::npos);
    EXPECT_EQ(refusal([](Scene& scene) { scene.mode = Mode::mip; }), "");
    EXPECT_EQ(refusal([](Scene& scene) { scene.mode = Mode::additive; }), "");
}
