// Truths of the path tracer: furnaces, numerical integration, the ray caster's medium in expectation, convergence, and
// equality over instruction sets and threads.
#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <numbers>

#include "fixtures.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/sh/directions.h"
#include "pathtrace/tracer.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr double pi = std::numbers::pi;

/// Everything a path-traced picture depends on.
struct Subject {
    Device device = Device::cpu(2);
    TransferFunction tf = two_materials();
    Shape shape;
    Lighting lighting;
    CameraSettings camera;
    RaySettings rays;
    PathOptions options;
    int width = 13, height = 11;

    std::unique_ptr<PathTracer> traced(const Volume& volume, int samples) const {
        const Camera from = make_camera(camera, volume.geometry, volume.dimensions);
        const Medium medium = classify(upload(device, volume), tf, shape);
        auto tracer = std::make_unique<PathTracer>(device, medium, lighting, from, rays, options, width, height);
        EXPECT_TRUE(tracer->add(samples, Progress()));
        return tracer;
    }
    Frame frame(const Volume& volume, int samples) const {
        Frame f(width, height);
        traced(volume, samples)->show(f);
        return f;
    }
};

/// A probe whose rows have these radiances, from up to down.
Probe rows_of(const std::vector<float>& radiances) {
    std::vector<float> rgb;
    for (float r : radiances) rgb.insert(rgb.end(), {r, r, r});
    return Probe(1, int(radiances.size()), rgb);
}

/// The same from everywhere but for a hair, so that light is drawn and weighed.
Probe nearly_white() { return Probe(2, 1, {1, 1, 1, 1.0001f, 1.0001f, 1.0001f}); }

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
        subject.options = {.albedo_max = 1, .start_half_edges = 0};
        subject.width = subject.height = 64;
    }
    /// Mean and its standard error over all pixels, which all see the same.
    std::pair<double, double> light(int samples) const {
        const auto tracer = subject.traced(volume, samples);
        double sum = 0, squares = 0;
        for (const PixelSum& pixel : tracer->sums()) sum += pixel.g, squares += pixel.luminance_squares;
        const double n = double(samples) * subject.width * subject.height;
        return {sum / n, std::sqrt((squares / n - sum / n * sum / n) / n)};
    }
};

/// Medium by marching in double precision, from the definition.
class Marched {
public:
    Marched(const Volume& volume, const TransferFunction& tf, const Shape& shape)
        : volume_(volume), voxels_(upload(Device::cpu(1), volume)), medium_(classify(voxels_, tf, shape)) {}

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

Volume small_shells() {
    return sampled<std::uint8_t>({20, 18, 17}, [](double x, double y, double z) { return shells(x, y, z, 19); });
}

/// Opacity of the eye's ways against the ray caster's at a fine step.
void expect_opacity_of_marching(const Volume& volume, Subject subject, int samples) {
    subject.width = 23, subject.height = 19;
    subject.options.bounces = 0;
    Shot shot{.tf = subject.tf, .camera = subject.camera, .width = subject.width, .height = subject.height};
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

}  // namespace

// Albedo 1 under light 1: what is not seen through is as bright as what is, so nothing can be seen.
TEST(PathTracer, FurnaceIsInvisible) {
    const Volume volume = small_shells();
    Subject subject;
    for (ControlPoint& point : subject.tf.points) point.rgb = {1, 1, 1};
    for (double start : {0.0, 1.0}) {
        subject.options = {.albedo_max = 1, .start_half_edges = start};
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
        const double variance = (pixel.luminance_squares - pixel.g * pixel.g / samples) / samples;
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
}

// A dense spot in wide thin fog is met as often as it should be.
TEST(PathTracer, MajorantsBringNoBias) {
    const Volume volume = sampled<std::uint8_t>(
        {33, 33, 33}, [](double x, double y, double z) { return x == 16 && y == 15 && z == 18 ? 250 : 40; });
    Subject subject;
    subject.tf.points = {{0, {1, 1, 1}, 0.005}, {50, {1, 1, 1}, 0.005}, {100, {1, 1, 1}, 0.9}};
    subject.camera.zoom = 8;
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
    const ProbePicture& picture = subject.lighting.loaded_probe.data().picture;
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
                if (const float radiance = picture.rgb[3 * std::min(int(picture.place(d).y), 3)]; radiance > 0)
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
            const double variance = (pixel.luminance_squares - pixel.g * pixel.g / samples) / samples;
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

TEST(PathTracer, NoiseFallsWithTheRootOfThePaths) {
    const Volume volume = small_shells();
    Subject subject;
    subject.lighting.loaded_probe = builtin_probe("studio");
    subject.width = 40, subject.height = 30;
    const auto few = subject.traced(volume, 64), many = subject.traced(volume, 256);
    EXPECT_NEAR(few->statistics().noise / many->statistics().noise, 2, 0.1);
    EXPECT_EQ(many->statistics().samples, 256);
    // And it is what two pictures differ by.
    Subject other = subject;
    other.options.seed = 7;
    const auto again = other.traced(volume, 64);
    double squares = 0;
    for (std::size_t p = 0; p < few->sums().size(); ++p) {
        double difference = 0;
        const PixelSum &a = few->sums()[p], &b = again->sums()[p];
        difference += luminance_weights[0] * (a.r - b.r) + luminance_weights[1] * (a.g - b.g) +
                      luminance_weights[2] * (a.b - b.b);
        squares += std::pow(difference / 64, 2) / double(few->sums().size());
    }
    EXPECT_NEAR(std::sqrt(squares / 2) / few->statistics().noise, 1, 0.1);
}

// Lambert: on a convex surface nothing stands in the way of light, so E = ρ; in half the light by the side it faces.
TEST(PathTracer, ConvexSurfacesAreAsBrightAsTheirColour) {
    const Volume ball = sampled<float>({24, 24, 24}, [](double x, double y, double z) {
        return 100 - 5 * std::sqrt((x - 11.5) * (x - 11.5) + (y - 11.5) * (y - 11.5) + (z - 11.5) * (z - 11.5));
    });
    Subject subject;
    subject.shape.mode = Mode::iso;
    subject.shape.iso = {{60, Rgb{1, 1, 1}}};
    subject.options.bounces = 0;
    subject.width = subject.height = 25;
    for (const bool drawn : {false, true}) {
        if (drawn) subject.lighting.loaded_probe = nearly_white();
        const auto tracer = subject.traced(ball, 64);
        int seen = 0;
        for (const PixelSum& pixel : tracer->sums()) {
            if (pixel.a == 0) continue;
            ++seen;
            EXPECT_EQ(pixel.a, 64);
            EXPECT_NEAR(pixel.g / 64, 1, drawn ? 0.3 : 1e-6);
        }
        EXPECT_GT(seen, 50);
        EXPECT_LT(seen, 400);
    }
    subject.lighting.loaded_probe = {};
    subject.options.bounces.reset();  // then the colour is an albedo, capped
    EXPECT_NEAR(subject.frame(ball, 4).rgba[4 * (12 * 25 + 12)], 0.9, 1e-6);
    // Cut open, it has the plane's normal: up.
    subject.shape.clip.planes = {{{0, 0, 1}, 12}};
    subject.camera.elevation_deg = 90;
    subject.lighting.loaded_probe = rows_of({1, 0});
    const Frame cut = subject.frame(ball, 256);
    EXPECT_NEAR(cut.rgba[4 * (12 * 25 + 12)], 0.9, 0.02);
}

TEST(PathTracer, SurfacesLetTheirShareThrough) {
    Volume ramp = sampled<float>({16, 16, 16}, [](double, double, double z) { return 10 * z; });
    ramp.geometry.spacing_mm = {200, 200, 1};  // so wide that no light comes from the sides
    Subject subject;
    subject.shape.mode = Mode::iso;
    subject.shape.iso = {{42, Rgb{1, 0, 0}, 0.25}, {81, Rgb{0, 1, 0}, 0.5}};
    subject.camera.elevation_deg = 90;
    subject.camera.projection = Projection::orthographic;
    subject.camera.zoom = 1000;
    subject.options.bounces = 0;
    const Frame frame = subject.frame(ramp, 1500);
    double red = 0, green = 0, alpha = 0;
    const double pixels = double(frame.rgba.size()) / 4;
    for (std::size_t p = 0; p < frame.rgba.size(); p += 4)
        red += frame.rgba[p] / pixels, green += frame.rgba[p + 1] / pixels, alpha += frame.rgba[p + 3] / pixels;
    EXPECT_NEAR(alpha, 1 - 0.5 * 0.75, 0.005);
    EXPECT_NEAR(green, 0.5, 0.005);  // nothing stands above it
    // Seen through the upper one, and lit through it: the side that faces the eye is lit from there alone.
    EXPECT_NEAR(red, 0.5 * 0.25 * 0.5, 0.005);
}

TEST(PathTracer, EveryInstructionSetAndThreadCountGivesTheSameBits) {
    const Volume volume = small_shells();
    for (const Mode mode : {Mode::dvr, Mode::iso}) {
        Subject subject;
        subject.shape.mode = mode;
        subject.shape.iso = {{70, {}, 0.5}, {150}};
        subject.lighting.loaded_probe = builtin_probe("studio");
        subject.lighting.probe = {"studio", 40, 0.5, false};
        subject.options.anisotropy = 0.4;
        subject.rays.samples_per_pixel = 3;
        subject.width = 77, subject.height = 67;  // several tiles, no multiples
        subject.device = Device::cpu(1, Isa::scalar);
        const Frame scalar = subject.frame(volume, 3);
        EXPECT_GT(mean_alpha(scalar), 0.05);
        for (Isa isa : available_isas())
            for (int threads : {1, 3}) {
                subject.device = Device::cpu(threads, isa);
                const Frame frame = subject.frame(volume, 3);
                EXPECT_EQ(std::memcmp(frame.rgba.data(), scalar.rgba.data(), 4 * frame.rgba.size()), 0)
                    << name_of(isa) << ", " << threads << " threads, mode " << int(mode);
            }
    }
}

// What the kernel draws follows its own densities, and these integrate to 1.
TEST(LightTable, DrawsFollowTheDensities) {
    std::vector<float> rgb;
    for (int i = 0; i < 8 * 6; ++i)
        for (int c = 0; c < 3; ++c) rgb.push_back(float((i * 37 + 11) % 17) / (i % 5 == 0 ? 0.3f : 3.0f));
    Lighting lighting;
    lighting.loaded_probe = Probe(8, 6, rgb);
    lighting.probe.rotation_deg = 33;
    const LightTable table(lighting, {0, 0, 1});
    const kernel::ProbeLightView view = table.view();
    const ProbePicture& picture = lighting.loaded_probe.data().picture;
    const Axes probe_from_world = transposed(world_from_probe(33, {0, 0, 1}));
    std::vector<double> counts(48), expected(48);
    constexpr int draws = 200000;
    for (int i = 0; i < draws; ++i) {
        const auto key = kernel::random_key<float>(i, 5);
        const kernel::Vec3<float> d = view.towards<float>(kernel::draw(key, 0), kernel::draw(key, 1));
        EXPECT_NEAR(d.x * d.x + d.y * d.y + d.z * d.z, 1, 1e-5);
        const auto place = picture.place(turned(probe_from_world, {d.x, d.y, d.z}));
        counts[std::size_t(std::min(int(place.y), 5)) * 8 + std::min(int(place.x), 7)] += 1;
    }
    double chi_square = 0, integral = 0;
    int cells = 0;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x) {
            const Vec3 world = turned(transposed(probe_from_world), picture.direction(x + 0.5, y + 0.5));
            const auto seen = view.at<float>({float(world.x), float(world.y), float(world.z)});
            const double share = seen.density * picture.solid_angle(y), n = counts[std::size_t(y) * 8 + x];
            EXPECT_NEAR(seen.radiance.y, rgb[3 * (y * 8 + x) + 1], 1e-6);
            integral += share;
            if (share == 0) {
                EXPECT_EQ(n, 0);
                continue;
            }
            ++cells;
            chi_square += std::pow(n - draws * share, 2) / (draws * share);
        }
    EXPECT_NEAR(integral, 1, 1e-5);
    EXPECT_LT(chi_square, cells - 1 + 4 * std::sqrt(2.0 * (cells - 1)));
}

TEST(PhaseFunction, DrawsFollowTheDensity) {
    for (float g : {0.0f, 0.5f, -0.9f}) {
        const kernel::PhaseView phase{g};
        std::vector<double> counts(20);
        constexpr int draws = 100000;
        double mean = 0;
        for (int i = 0; i < draws; ++i) {
            const float cosine = phase.cosine((float(i) + 0.5f) / draws);
            mean += cosine / draws;
            counts[std::min(int((cosine + 1) * 10), 19)] += 1.0 / draws;
        }
        EXPECT_NEAR(mean, g, 1e-3);  // g is the mean cosine
        for (int bin = 0; bin < 20; ++bin) {
            double share = 0;
            for (int i = 0; i < 1000; ++i)
                share += 2 * pi * phase.density(float(-1 + (bin + (i + 0.5) / 1000) / 10)) * 1e-4;
            EXPECT_NEAR(counts[bin], share, 2e-3) << g << " bin " << bin;
        }
    }
}

namespace {

struct Call {
    Volume volume = small_shells();
    Device device = Device::cpu(2);
    IlluminationSettings settings{.method = Method::reference};
    Shape shape;
    Frame frame{20, 15};
    Progress progress;

    Outcome operator()(const FramePreview& preview = {}) {
        const DeviceVolume voxels = upload(device, volume);
        return trace_paths(device, classify(voxels, two_materials(), shape), {},
                           make_camera({}, voxels.geometry(), voxels.dimensions()), {}, settings, frame, progress,
                           preview);
    }
};

}  // namespace

TEST(TracePaths, StopsAtPathsErrorOrTime) {
    Call call;
    call.settings.reference.rays = 21;
    std::vector<Frame> previews;
    const Outcome all = call([&](const Frame& frame) { previews.push_back(frame); });
    EXPECT_TRUE(all.complete);
    EXPECT_EQ(all.paths.samples, 21);
    EXPECT_GT(all.paths.noise, 0);
    EXPECT_GT(all.samples, 21u * 20);
    ASSERT_EQ(previews.size(), 6u);  // 1 + 1 + 2 + 4 + 8 + 5
    EXPECT_EQ(previews.back().rgba, call.frame.rgba);
    EXPECT_NE(previews.front().rgba, call.frame.rgba);

    call.settings.reference.rays = 60000;
    call.settings.reference.error = 0.05;
    const Outcome sure = call();
    EXPECT_LE(sure.paths.relative_noise, 0.05);
    EXPECT_LT(sure.paths.samples, 2000);

    call.settings.reference.error.reset();
    call.settings.reference.time_s = 0.05;
    const Outcome hurried = call();
    EXPECT_TRUE(hurried.complete);
    EXPECT_LT(hurried.paths.samples, 60000);
}

TEST(TracePaths, CancelsWithinAPass) {
    Call call;
    call.settings.reference.rays = 60000;
    int passes = 0;
    const Outcome outcome = call([&](const Frame&) {
        if (++passes == 3) call.progress.cancel();
    });
    EXPECT_FALSE(outcome.complete);
    EXPECT_EQ(passes, 3);
}

TEST(TracePaths, RefusesMaximaAlongRays) {
    Call call;
    call.shape.mode = Mode::mip;
    try {
        call();
        FAIL() << "traced";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_NE(std::string(error.what()).find("maximum along a ray"), std::string::npos);
    }
}
