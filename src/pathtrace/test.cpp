// Truths of the path tracer: furnaces, numerical integration, the ray caster's medium in expectation.
#include <algorithm>

#include "illumination/probe/data.h"
#include "illumination/sh/directions.h"
#include "path_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A slab of optical depth 5, 5 mm thick and endless sideways, seen from above.
struct Slab {
    static constexpr double thickness = 5, voxel = 0.025;
    Volume volume = sampled<std::uint8_t>({3, 3, 201}, [](double, double, double) { return 100; });
    Subject subject;

    Slab() {
        volume.geometry.spacing_mm = {1e4, 1e4, voxel};
        subject.tf = constant(-std::expm1(-1.0));
        subject.tf.opacity_unit_is_mm = true;
        subject.camera.projection = Projection::orthographic;
        subject.camera.elevation_deg = 90;
        subject.camera.zoom = 1e4;
        subject.options = {.albedo_max = 1, .start_half_voxels = 0};
        subject.width = subject.height = 64;
    }
    /// Mean and its standard error over all pixels, which all see the same.
    std::pair<double, double> light(int samples) const {
        const auto tracer = subject.traced(volume, samples);
        double sum = 0, squares = 0;
        for (const PixelSum& pixel : tracer->sums()) sum += pixel.g, squares += pixel.squares;
        const double n = double(samples) * subject.width * subject.height;
        return {sum / n, std::sqrt((squares / n - sum / n * sum / n) / n)};
    }
};

/// Medium by marching in double precision, from the definition.
class Marched {
public:
    Marched(const Volume& volume, const TransferFunction& tf, const Shape& shape)
        : volume_(volume), voxels_(upload(tested_device(), volume)), medium_(classify(voxels_, tf, shape)) {}

    const Medium& medium() const { return medium_; }

    OpticalTable::Entry entry(Vec3 p) const {
        double value = 0;
        std::array<int, 3> i;
        Vec3 t;
        for (int a = 0; a < 3; ++a) {
            const double x = std::clamp(p[a], 0.0, double(volume_.dimensions[a] - 1));
            i[a] = std::min(int(x), volume_.dimensions[a] - 2);
            t[a] = x - i[a];
        }
        const auto voxels = volume_.as<std::uint8_t>();
        for (int corner = 0; corner < 8; ++corner) {
            const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
            const double weight = (dx ? t.x : 1 - t.x) * (dy ? t.y : 1 - t.y) * (dz ? t.z : 1 - t.z);
            value +=
                weight * voxels[(std::size_t(i[2] + dz) * volume_.dimensions[1] + i[1] + dy) * volume_.dimensions[0] +
                                i[0] + dx];
        }
        const OpticalTable& table = medium_.data().table;
        const double index = std::clamp(table.index_of(value) + 0.5, 0.0, double(table.entries.size() - 1));
        return table.entries[std::size_t(index)];
    }

    /// From `start` on until whole voxels end. Unit spacing only.
    double transmittance(Vec3 p, Vec3 d, double start, double step) const {
        double depth = 0;
        for (double t = start + step / 2; depth < 20; t += step) {
            const Vec3 q = p + t * d;
            for (int a = 0; a < 3; ++a)
                if (q[a] < -0.5 || q[a] > volume_.dimensions[a] - 0.5) return std::exp(-depth);
            depth += step * entry(q).extinction_per_mm;
        }
        return 0;
    }

private:
    const Volume& volume_;
    DeviceVolume voxels_;
    Medium medium_;
};

/// How far each pixel's mean lies from what is expected, in its standard errors.
struct ZTest {
    double largest = 0, squares = 0;
    int pixels = 0;

    void add(double found, double expected, double standard_error) {
        const double z = (found - expected) / standard_error;
        largest = std::max(largest, std::abs(z)), squares += z * z, ++pixels;
    }
    /// Neither is any pixel too far out, at one in 10^4 over all of them (Bonferroni), nor the sum of squares, whose
    /// distribution is nearly normal.
    void expect_pass() const {
        ASSERT_GT(pixels, 20);
        const double bound = std::sqrt(2 * std::log(1e4 * pixels));  // P(|Z| > b) < exp(-b²/2)
        EXPECT_LT(largest, bound);
        EXPECT_LT(std::abs(squares - pixels) / std::sqrt(2.0 * pixels), 4) << squares << " over " << pixels;
    }
};

/// Opacity of the eye's ways against the ray caster's at a fine step.
void expect_opacity_of_marching(const Volume& volume, Subject subject, int samples) {
    subject.width = 23, subject.height = 19;
    subject.options.bounces = 0;
    Shot shot{.tf = subject.tf,
              .shape = subject.shape,
              .camera = subject.camera,
              .width = subject.width,
              .height = subject.height};
    shot.rays.step_voxels = 0.004;
    const Frame marched = shot(volume);
    const auto tracer = subject.traced(volume, samples);
    ZTest test;
    for (std::size_t p = 0; p < tracer->sums().size(); ++p) {
        const double expected = marched.rgba[4 * p + 3], found = tracer->sums()[p].a / samples;
        if (expected > 0.02 && expected < 0.98)
            test.add(found, expected, std::sqrt(expected * (1 - expected) / samples));
        else
            EXPECT_NEAR(found, expected, 0.06);
    }
    test.expect_pass();
}

/// What a probe's table draws, in numbers of the test's own.
struct DrawnLight {
    explicit DrawnLight(const Probe& probe) : table(Lighting{.loaded_probe = probe}, {0, 0, 1}), view(table.view()) {}

    double density(Vec3 d) const { return view.at(kernel::Vec3<float>{float(d.x), float(d.y), float(d.z)}).density; }
    Vec3 direction(std::int32_t number) const {
        const auto key = kernel::random_key<float>(number, 0);
        const auto d = view.towards(kernel::draw<float>(key, 0), kernel::draw<float>(key, 1)).direction;
        return {d.x, d.y, d.z};
    }

    LightTable table;
    kernel::ProbeLightView view;
};

}  // namespace

TEST(LightTable, DensityIntegratesToOneAndIsProportionalToLuminance) {
    for (const char* name : {"sky", "studio", "windows"}) {
        const Probe probe = builtin_probe(name);
        const ProbeImage& image = probe.data().image;
        const DrawnLight light(probe);
        double sum = 0, light_sum = 0, worst = 0;
        std::vector<std::pair<double, double>> pairs;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                double luminance = 0;
                for (int c = 0; c < 3; ++c)
                    luminance += luminance_weights[c] * image.rgb[3 * (std::size_t(y) * image.width + x) + c];
                pairs.emplace_back(light.density(image.direction(x + 0.5, y + 0.5)), luminance);
                sum += pairs.back().first * image.solid_angle(y), light_sum += luminance * image.solid_angle(y);
            }
        for (const auto& [density, luminance] : pairs)
            worst = std::max(worst, std::abs(density - luminance / light_sum) / density);
        EXPECT_NEAR(sum, 1, 1e-5) << name;
        EXPECT_LT(worst, 1e-5) << name;
    }
}

TEST(LightTable, NothingIsDrawnFromEvenLight) {
    EXPECT_TRUE(DrawnLight(builtin_probe("white")).view.even);
    EXPECT_TRUE(DrawnLight(Probe(3, 2, std::vector<float>(18))).view.even);
}

TEST(LightTable, DrawsFollowTheDensity) {
    constexpr int width = 16, height = 8, count = 200000;
    ProbeImage image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec3 d = image.direction(x + 0.5, y + 0.5);
            const float brightness = d.z > 0 ? 0 : float(1 + d.x);
            image.rgb.insert(image.rgb.end(), {brightness, brightness, 1e-3f});
        }
    const DrawnLight light(Probe(width, height, image.rgb));
    std::vector<int> hits(width * height);
    Vec3 inverse;  // Σ ω / density: even over the sphere, so it is ∫ ω
    double area = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 d = light.direction(i);
        ASSERT_NEAR(length(d), 1, 1e-6);
        const auto [x, y] = image.place(d);
        ++hits[width * std::min(int(y), height - 1) + int(x) % width];
        const double weight = 1 / light.density(d) / count;
        if (d.z < 0) area += weight, inverse = inverse + weight * d;
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double share = light.density(image.direction(x + 0.5, y + 0.5)) * image.solid_angle(y),
                         expected = count * share;
            EXPECT_NEAR(hits[width * y + x], expected, 5 * std::sqrt(expected) + 1) << x << " " << y;
        }
    EXPECT_NEAR(area, 2 * std::numbers::pi, 0.05);  // of the lower half
    EXPECT_NEAR(inverse.z, -std::numbers::pi, 0.05);
    EXPECT_NEAR(inverse.x, 0, 0.05);
}

// Albedo 1 under light 1: what is not seen through is as bright as what is, so nothing can be seen.
TEST(PathTracer, FurnaceIsInvisible) {
    const Volume volume = small_shells();
    Subject subject;
    for (ControlPoint& point : subject.tf.points) point.rgb = {1, 1, 1};
    for (double start : {0.0, 1.0}) {
        subject.options = {.albedo_max = 1, .start_half_voxels = start};
        const auto tracer = subject.traced(volume, 8);
        for (const PixelSum& pixel : tracer->sums()) EXPECT_EQ(pixel.g, pixel.a);
    }
    // With light that is drawn and weighed the same holds on average.
    subject.lighting.loaded_probe = nearly_white();
    constexpr int samples = 400;
    ZTest test;
    const auto tracer = subject.traced(volume, samples);
    for (const PixelSum& pixel : tracer->sums()) {
        const double background = samples - pixel.a, mean = (pixel.g + background) / samples;
        const double variance = (pixel.squares - pixel.g * pixel.g / samples) / samples;
        if (pixel.a < 0.2 * samples) continue;
        test.add(mean, 1.00005, std::sqrt(variance / samples));
    }
    ASSERT_GT(test.pixels, 15);
    EXPECT_LT(test.largest, 5);
}

// Illumination.md's figures: 1 minus the share of longer ways.
TEST(PathTracer, SlabOfOpticalDepthFive) {
    Slab slab;
    const double behind = std::exp(-5.0);
    for (const auto& [scatterings, share] : {std::pair{1, 0.17}, {2, 0.27}, {5, 0.46}, {65, 0.994}}) {
        slab.subject.options.bounces = scatterings - 1;
        const auto [light, error] = slab.light(16);
        EXPECT_NEAR(light + behind, share, 0.005 + 3 * error) << scatterings;
        EXPECT_LT(error, 0.003);
    }
}

// L = ∫ κ exp(-κ t) ∫ P(g, ω·d) L(ω) T(t, ω) dω dt, by the midpoint rule over depth and cosine.
TEST(PathTracer, SingleScatteringIsTheIntegral) {
    Slab slab;
    const std::vector<float> radiances{4, 1, 0.5f, 0.25f, 0, 0, 2, 3};
    slab.subject.lighting.loaded_probe = rows_of(radiances);
    slab.subject.options.bounces = 0;
    for (double g : {0.0, 0.9, -0.9}) {
        slab.subject.options.anisotropy = g;
        double expected = 0;
        constexpr int depths = 400, cosines = 800;
        const double margin = Slab::voxel / 2;  // light passes whole voxels
        for (int i = 0; i < depths; ++i)
            for (int j = 0; j < cosines; ++j) {
                const double t = Slab::thickness * (i + 0.5) / depths, z = 2 * (j + 0.5) / cosines - 1;
                const double way = ((z > 0 ? t : Slab::thickness - t) + margin) / std::abs(z);
                const double phase = (1 - g * g) / (4 * pi * std::pow(1 + g * g + 2 * g * z, 1.5));
                const double radiance = radiances[std::min(int(std::acos(z) / pi * 8), 7)];
                expected += std::exp(-t) * phase * radiance * std::exp(-way) * 2 * pi * (2.0 / cosines) *
                            (Slab::thickness / depths);
            }
        const auto [light, error] = slab.light(32);
        EXPECT_NEAR(light, expected, 4 * error + 1e-3 * expected) << "g " << g;
        EXPECT_LT(error, 0.02 * expected) << "g " << g;
    }
}

TEST(PathTracer, OpacityIsThatOfMarching) {
    expect_opacity_of_marching(small_shells(), {}, 1500);
    Subject plain;
    plain.options.plain = true;
    expect_opacity_of_marching(small_shells(), plain, 500);
    for (const Interpolation interpolation : {Interpolation::cubic, Interpolation::smooth}) {
        Subject splined;
        splined.shape.interpolation = interpolation;
        expect_opacity_of_marching(small_shells(), splined, 1500);
    }
}

// A dense spot in wide thin fog is met as often as it should be.
TEST(PathTracer, MajorantsBringNoBias) {
    const Volume volume = sampled<std::uint8_t>(
        {33, 33, 33}, [](double x, double y, double z) { return x == 16 && y == 15 && z == 18 ? 250 : 40; });
    Subject subject;
    subject.tf.points = {{0, {1, 1, 1}, 0.005}, {50, {1, 1, 1}, 0.005}, {100, {1, 1, 1}, 0.9}};
    subject.camera.zoom = 8;
    expect_opacity_of_marching(volume, subject, 2000);
    subject.shape.interpolation = Interpolation::cubic;
    expect_opacity_of_marching(volume, subject, 2000);
}

// One scattering: every pixel's light is that of marching towards 200 directions from every step.
TEST(PathTracer, LightIsThatOfMarching) {
    const Volume volume = small_shells();
    Subject subject;
    subject.width = 8, subject.height = 7;
    subject.camera.projection = Projection::orthographic;
    subject.camera.zoom = 1.8;
    subject.lighting.loaded_probe = rows_of({3, 1, 0.2f, 1});
    subject.options.bounces = 0;
    const Marched marched(volume, subject.tf, subject.shape);
    const auto directions = fibonacci_directions(200);
    const ProbeImage& image = subject.lighting.loaded_probe.data().image;
    const auto expected_at = [&](int x, int y) {
        const Camera camera = make_camera(subject.camera, volume.geometry, volume.dimensions);
        const double px = ((x + 0.5) / subject.width * 2 - 1) * camera.half_height * subject.width / subject.height,
                     py = (1 - (y + 0.5) / subject.height * 2) * camera.half_height;
        const Vec3 origin = camera.eye + px * camera.right + py * camera.up;
        constexpr double step = 0.15;
        double light = 0, depth = 0;
        for (double t = step / 2; t < 200 && depth < 7; t += step) {
            const Vec3 p = origin + t * camera.forward;
            bool inside = true;
            for (int a = 0; a < 3; ++a) inside &= p[a] >= 0 && p[a] <= volume.dimensions[a] - 1;
            if (!inside) continue;
            const auto entry = marched.entry(p);
            if (entry.extinction_per_mm == 0) continue;
            double arrives = 0;
            for (const Vec3& d : directions)
                if (const float radiance = image.rgb[3 * std::min(int(image.place(d).y), 3)]; radiance > 0)
                    arrives += radiance * marched.transmittance(p, d, 0.5, 0.25) / double(directions.size());
            const double share = -std::expm1(-step * entry.extinction_per_mm);
            light += std::exp(-depth) * share * entry.g * arrives;
            depth += step * entry.extinction_per_mm;
        }
        return light;
    };
    constexpr int samples = 1200;
    const auto tracer = subject.traced(volume, samples);
    ZTest test;
    for (int y = 0; y < subject.height; ++y)
        for (int x = 0; x < subject.width; ++x) {
            const PixelSum& pixel = tracer->sums()[std::size_t(y) * subject.width + x];
            const double variance = (pixel.squares - pixel.g * pixel.g / samples) / samples;
            const double expected = expected_at(x, y);
            // What the marching itself may be wrong by: 1.5 %.
            if (expected > 0.02)
                test.add(pixel.g / samples, expected,
                         std::hypot(std::sqrt(std::abs(variance) / samples), 0.015 * expected));
        }
    ASSERT_GT(test.pixels, 20);
    EXPECT_LT(test.largest, 4.5);
    EXPECT_LT(test.squares, 2.0 * test.pixels);
}
