// The path tracer: noise, surfaces, what it draws, equality over instruction sets and threads, when it stops.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>

#include <algorithm>
#include <cstring>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "path_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

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
        const PixelSum &a = few->sums()[p], &b = again->sums()[p];
        for (const double difference : {a.r - b.r, a.g - b.g, a.b - b.b})
            squares += std::pow(difference / 64, 2) / double(3 * few->sums().size());
    }
    EXPECT_NEAR(std::sqrt(squares / 2) / few->statistics().noise, 1, 0.1);
}

// No path is so bright that its pixel stands out, though none is cut off: those that few directions bring much light to
// are drawn where the light is.
TEST(PathTracer, NoPixelIsFarFromTheTruth) {
    constexpr int few = 256, many = 4096;
    for (const std::string probe : {"studio", "sky"}) {
        const Volume volume = make_sample("tubes", 64);
        Subject subject;
        subject.tf = sample_transfer_function("tubes");
        subject.lighting.loaded_probe = builtin_probe(probe);
        subject.width = 64, subject.height = 48;
        const auto truth = subject.traced(volume, many);
        subject.options.seed = 5;
        const auto found = subject.traced(volume, few);
        const auto mean = [](const PixelSum& p, int paths) {
            return std::array{p.r / paths, p.g / paths, p.b / paths};
        };
        // Of a pixel's mean, over the three channels.
        const auto error_of = [&](const PixelSum& p, int paths) {
            const auto [r, g, b] = mean(p, paths);
            return std::max(0.0, p.squares / paths - (r * r + g * g + b * b) / 3) / paths;
        };
        int covered = 0, beyond = 0;
        double sum = 0, worst = 0;
        for (std::size_t i = 0; i < truth->sums().size(); ++i) {
            const PixelSum &a = truth->sums()[i], &b = found->sums()[i];
            if (a.a / many < 0.5) continue;
            ++covered;
            const auto of_truth = mean(a, many), of_found = mean(b, few);
            double squares = 0;
            for (std::size_t c = 0; c < 3; ++c)
                squares += std::pow(of_found[c] - of_truth[c], 2) / 3, sum += of_truth[c] / 3;
            worst = std::max(worst, std::sqrt(squares));
            beyond += squares > 64 * (error_of(a, many) + error_of(b, few));
        }
        ASSERT_GT(covered, 300);
        EXPECT_LT(worst, 10 * sum / covered) << probe;
        EXPECT_LT(beyond, 0.001 * covered) << probe;
        if (std::getenv("CHIARO_SHOW"))
            std::printf("%s: %d pixels, worst %.3f of the mean, %d beyond 8 errors\n", probe.c_str(), covered,
                        worst / (sum / covered), beyond);
    }
}

// Lambert: on a convex surface nothing stands in the way of light, so E = ρ; in half the light by the side it faces.
TEST(PathTracer, ConvexSurfacesAreAsBrightAsTheirColour) {
    const Volume ball = sampled<float>({24, 24, 24}, [](double x, double y, double z) {
        return 100 - 5 * std::sqrt((x - 11.5) * (x - 11.5) + (y - 11.5) * (y - 11.5) + (z - 11.5) * (z - 11.5));
    });
    Subject subject;
    subject.shape.mode = Mode::iso;
    subject.shape.iso = {{60, Rgb{1, 1, 1}}};
    subject.lighting.specular = 0;
    subject.options.bounces = 0;
    subject.width = subject.height = 25;
    for (const bool drawn : {false, true}) {
        if (drawn) subject.lighting.loaded_probe = nearly_white();
        const auto tracer = subject.traced(ball, 64);
        int seen = 0;
        double sum = 0, squares = 0;
        for (const PixelSum& pixel : tracer->sums()) {
            if (pixel.a == 0) continue;
            ++seen;
            EXPECT_EQ(pixel.a, 64);
            EXPECT_NEAR(pixel.g / 64, 1, drawn ? 0.3 : 1e-6);
            sum += pixel.g / 64, squares += std::pow(pixel.g / 64, 2);
        }
        const double mean = sum / seen, error = std::sqrt((squares / seen - mean * mean) / seen);
        EXPECT_NEAR(mean, 1, 4 * error + 1e-6) << error;
        EXPECT_LT(error, 0.02);
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
    subject.lighting.specular = 0;
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
    for (const auto& [mode, surfaces] : {std::pair{Mode::dvr, false}, {Mode::dvr, true}, {Mode::iso, false}}) {
        Subject subject;
        subject.shape.mode = mode;
        subject.options.surfaces = surfaces;
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
                    << name_of(isa) << ", " << threads << " threads, mode " << int(mode) << surfaces;
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
    const ProbeImage& image = lighting.loaded_probe.data().image;
    const Axes probe_from_world = transposed(world_from_probe(33, {0, 0, 1}));
    std::vector<double> counts(48), expected(48);
    constexpr int draws = 200000;
    int alike = 0;
    for (int i = 0; i < draws; ++i) {
        const auto key = kernel::random_key<float>(i, 5);
        const auto drawn = view.towards<float>(kernel::draw(key, 0), kernel::draw(key, 1));
        const kernel::Vec3<float> d = drawn.direction;
        alike += drawn.light.density == view.at<float>(d).density;
        EXPECT_NEAR(d.x * d.x + d.y * d.y + d.z * d.z, 1, 1e-5);
        const auto place = image.place(turned(probe_from_world, {d.x, d.y, d.z}));
        counts[std::size_t(std::min(int(place.y), 5)) * 8 + std::min(int(place.x), 7)] += 1;
    }
    double chi_square = 0, integral = 0;
    int cells = 0;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x) {
            const Vec3 world = turned(transposed(probe_from_world), image.direction(x + 0.5, y + 0.5));
            const auto seen = view.at<float>({float(world.x), float(world.y), float(world.z)});
            const double share = seen.density * image.solid_angle(y), n = counts[std::size_t(y) * 8 + x];
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
    EXPECT_GT(alike, 0.9999 * draws);  // but where rounding takes a direction over a bin's border
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

/// A path along -v that met a surface with the normal z.
kernel::Path<float> met_from(const kernel::ReflectionView& view, const kernel::Vec3<float>& v) {
    kernel::Path<float> path;
    path.normal = {0, 0, 1}, path.heading = {-v.x, -v.y, -v.z};
    path.shining = view.highlight(path.normal, path.heading);
    return path;
}

/// f (n·l) of white matter.
double reflected(const kernel::ReflectionView& view, const kernel::Vec3<float>& v, const kernel::Vec3<float>& l) {
    const auto found = view.scattered(met_from(view, v), l);
    return double(found.coloured) + double(found.shine);
}

kernel::Vec3<float> direction_at(double cosine, double turns) {
    return kernel::around<float>({0, 0, 1}, float(cosine), float(turns));
}

// f(a, b) = f(b, a), and drawn directions follow the density, the light above the horizon adding up to at most all.
TEST(Reflection, IsReciprocalAndKeepsItsEnergy) {
    for (const auto& [strength, shininess] :
         {std::pair{0.0, 20.0}, {0.3, 20.0}, {1.0, 5.0}, {0.5, 0.0}, {10.0, 200.0}, {10.0, 2.0}}) {
        const ReflectionTable table(strength, shininess);
        const kernel::ReflectionView view = view_of(table);
        for (const double a : {0.15, 0.5, 0.95})
            for (const double b : {0.3, 0.8})
                for (const double turns : {0.0, 0.2, 0.5}) {
                    const auto v = direction_at(a, 0), l = direction_at(b, turns);
                    const double there = reflected(view, v, l) / b, back = reflected(view, l, v) / a;
                    EXPECT_NEAR(there, back, 0.002 * (there + back) + 1e-4) << strength << " " << shininess;
                }
        for (const double cosine : {0.1, 0.6, 1.0}) {
            const auto v = direction_at(cosine, 0.1);
            const auto path = met_from(view, v);
            double sum = 0;
            constexpr int draws = 1 << 16;
            for (int i = 0; i < draws; ++i) {
                const auto numbers = kernel::draw(kernel::random_key<float>(i, 7), 0);
                const auto found = view.scattered(path, view.direction(path, numbers));
                sum += (double(found.coloured) + double(found.shine)) / std::max(double(found.density), 1e-30) / draws;
            }
            EXPECT_NEAR(sum, 1, 0.01) << strength << " " << shininess << " " << cosine;
        }
    }
}

namespace {

struct Call {
    Volume volume = small_shells();
    Device device = tested_device();
    IlluminationSettings settings{.method = Method::reference};
    Shape shape;
    Frame frame{20, 15};
    Progress progress;

    RenderStatistics operator()(const FramePreview& preview = {}) {
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
    const RenderStatistics all = call([&](const Frame& frame, const PathStatistics&) { previews.push_back(frame); });
    EXPECT_TRUE(all.complete);
    EXPECT_EQ(all.paths.samples, 21);
    EXPECT_GT(all.paths.noise, 0);
    EXPECT_GT(all.samples, 21u * 20);
    ASSERT_EQ(previews.size(), 6u);  // 1 + 1 + 2 + 4 + 8 + 5
    EXPECT_EQ(previews.back().rgba, call.frame.rgba);
    EXPECT_NE(previews.front().rgba, call.frame.rgba);

    call.settings.reference.rays = 60000;
    call.settings.reference.error = 0.05;
    const RenderStatistics sure = call();
    EXPECT_LE(sure.paths.relative_noise, 0.05);
    EXPECT_LT(sure.paths.samples, 2000);

    call.settings.reference.error.reset();
    call.settings.reference.time_s = 0.05;
    const RenderStatistics hurried = call();
    EXPECT_TRUE(hurried.complete);
    EXPECT_LT(hurried.paths.samples, 60000);
}

TEST(TracePaths, CancelsWithinAPass) {
    Call call;
    call.settings.reference.rays = 60000;
    int passes = 0;
    const RenderStatistics render_statistics = call([&](const Frame&, const PathStatistics&) {
        if (++passes == 3) call.progress.cancel();
    });
    EXPECT_FALSE(render_statistics.complete);
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
        EXPECT_NE(std::string(error.what()).find("value of a whole ray"), std::string::npos);
    }
}

TEST(TracePaths, TakesTheRayCastersPlaceInASession) {
    Progress progress;
    Session session(tested_device());
    session.show(make_sample("ball", 16), progress);
    Scene scene;
    scene.volume = "sample:ball:16", scene.width = 24, scene.height = 18;
    scene.illumination.method = Method::reference;
    scene.illumination.reference.rays = 4;
    scene.illumination.scattering.bounces.most = 0;
    std::vector<Image> previews;
    const Image first = session.render(scene, progress, [&](const Image& image) { previews.push_back(image); });
    EXPECT_EQ(session.render_statistics().paths.samples, 4);
    ASSERT_EQ(previews.size(), 3u);
    EXPECT_EQ(previews.back().pixels, first.pixels);
    EXPECT_EQ(render_image(Device::cpu(1), scene, progress).pixels, first.pixels);

    scene.illumination.scattering.seed = 1;
    EXPECT_NE(session.render(scene, progress).pixels, first.pixels);
    scene.illumination.reference.quantity = ReferenceQuantity::obscurance;
    session.render(scene, progress);
    EXPECT_EQ(session.render_statistics().paths.samples, 0);

    // A picture is no field; what is not said is obscurance there.
    scene.illumination.reference.quantity = ReferenceQuantity::radiance;
    EXPECT_THROW(session.compute_field(scene, progress), Error);
    scene.illumination.reference.quantity.reset();
    const auto told = session.compute_field(scene, progress).volume.key_values;
    EXPECT_EQ(told.at("chiaro_reference_quantity"), "obscurance");
}

TEST(Bounces, AreANumberOrUnlimited) {
    Bounces bounces{3};
    from_text("unlimited", bounces);
    EXPECT_EQ(bounces, Bounces{});
    EXPECT_EQ(to_text(bounces), "unlimited");
    from_text("0", bounces);
    EXPECT_EQ(bounces.most, 0);
    EXPECT_EQ(to_text(bounces), "0");
    for (const char* wrong : {"", "many", "-1", "1.5", "1,2"}) EXPECT_THROW(from_text(wrong, bounces), Error) << wrong;
}
