// Mean radiance by paths: closed forms, furnaces, equality over instruction sets and threads, when it stops.
#include <chiaro/error.h>
#include <chiaro/text.h>

#include <cstring>

#include "path_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Everything that J at points depends on.
struct Points {
    Device device = tested_device();
    TransferFunction tf = two_materials();
    Shape shape;
    Lighting lighting;
    IlluminationSettings settings{.method = Method::reference};
    std::vector<Vec3> at;

    Points() {
        settings.reference.rays = 20000, settings.reference.start_half_voxels = 0;
        settings.scattering.albedo_max = 1;
    }
    MeanRadiance operator()(const Volume& volume) const {
        Progress progress;
        const Medium medium = classify(upload(device, volume), tf, shape);
        return trace_mean_radiance(device, medium, lighting, {0, 0, 1}, at, settings, progress);
    }
};

/// Extinction 1 per mm and this colour wherever there is a value.
TransferFunction absorbing(Rgb colour) {
    TransferFunction tf = constant(-std::expm1(-1.0));
    tf.opacity_unit_is_mm = true;
    for (ControlPoint& point : tf.points) point.rgb = colour;
    return tf;
}

/// E_2(x) = ∫ exp(-x / μ) dμ over (0, 1), by the midpoint rule.
double exponential_integral_2(double x) {
    constexpr int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += std::exp(-x * n / (i + 0.5)) / n;
    return sum;
}

/// `depth` mm of extinction 1 per mm, endless sideways; z counts from the border.
struct Layer {
    static constexpr int voxels = 200;
    double voxel;
    Volume volume = sampled<std::uint8_t>({3, 3, voxels}, [](double, double, double) { return 100; });

    explicit Layer(double depth) : voxel(depth / voxels) { volume.geometry.spacing_mm = {1e4, 1e4, voxel}; }
    Vec3 at(double depth) const { return {1, 1, depth / voxel - 0.5}; }
};

}  // namespace

TEST(MeanRadiance, EmptyVolumesLetAllLightThrough) {
    const Volume volume = sampled<std::uint8_t>({8, 8, 8}, [](double, double, double) { return 0; });
    Points points;
    points.settings.reference.rays = 2000;
    points.at = {{3.5, 3.5, 3.5}, {0, 0, 7}, {-20, 3, 3}};
    for (const Rgb& j : points(volume).mean) EXPECT_EQ(j, (Rgb{1, 1, 1}));
    // Drawn and weighed, from an uneven probe: its mean.
    points.lighting.loaded_probe = Probe(4, 2, std::vector<float>{8, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 0,  //
                                                                  0, 4, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    const MeanRadiance drawn = points(volume);
    for (std::size_t i = 0; i < drawn.mean.size(); ++i) {
        EXPECT_LT(drawn.error[i], 0.05);
        EXPECT_NEAR(drawn.mean[i][0], 8.0 / 8, 5 * drawn.error[i]);
        EXPECT_NEAR(drawn.mean[i][1], 5.0 / 8, 5 * drawn.error[i]);
        EXPECT_NEAR(drawn.mean[i][2], 7.0 / 8, 5 * drawn.error[i]);
    }
}

// Albedo 1 under light 1: J = 1 everywhere, whatever the phase function, and on isosurfaces too.
TEST(MeanRadiance, FurnaceIsInvisible) {
    const Volume volume = small_shells();
    Points points;
    points.settings.reference.rays = 100;
    for (ControlPoint& point : points.tf.points) point.rgb = {1, 1, 1};
    points.at = {{9.5, 8.5, 8}, {3, 4, 5}, {0, 0, 0}, {16, 2, 9}, {9.2, 8.1, 14.6}, {-3, 9, 9}};
    points.shape.iso = {{70, Rgb{1, 1, 1}}};
    points.lighting.specular = 0;  // highlights weigh paths: as sure as other light, not exact
    for (const Mode mode : {Mode::dvr, Mode::iso}) {
        points.shape.mode = mode;
        points.lighting.loaded_probe = {};
        for (const Rgb& j : points(volume).mean) EXPECT_EQ(j, (Rgb{1, 1, 1}));
        points.lighting.loaded_probe = nearly_white();
        for (const double g : {0.0, 0.6}) {
            points.settings.scattering.anisotropy = g;
            const MeanRadiance drawn = points(volume);
            for (std::size_t i = 0; i < drawn.mean.size(); ++i) {
                EXPECT_NEAR(drawn.mean[i][1], 1.00005, 5 * drawn.error[i]) << i << " g " << g;
                EXPECT_LT(drawn.error[i], 0.03);
            }
        }
    }
}

// From its centre every way out of a ball is R long: where it only absorbs, J = exp(-κ R).
TEST(MeanRadiance, CentreOfAnAbsorbingBall) {
    constexpr double radius = 20;
    const Volume ball = sampled<float>({49, 49, 49}, [](double x, double y, double z) {
        return 1000 - std::sqrt((x - 24) * (x - 24) + (y - 24) * (y - 24) + (z - 24) * (z - 24));
    });
    for (const double depth : {0.5, 2.0}) {
        Points points;
        points.tf = absorbing({0, 0, 0});
        points.tf.points = {{1000 - radius - 1e-3, {0, 0, 0}, 0},
                            {1000 - radius + 1e-3, {0, 0, 0}, -std::expm1(-depth / radius)},
                            {1000, {0, 0, 0}, -std::expm1(-depth / radius)}};
        points.at = {{24, 24, 24}};
        const MeanRadiance mean_radiance = points(ball);
        EXPECT_NEAR(mean_radiance.mean[0][1], std::exp(-depth),
                    4 * mean_radiance.error[0] + 0.01 * depth * std::exp(-depth));
        EXPECT_LT(mean_radiance.error[0], 0.004);
    }
}

// J at depth t of a slab that is T thick: (E_2(t) + E_2(T - t)) / 2, in the middle E_2(κ a).
TEST(MeanRadiance, DepthsOfAnAbsorbingSlab) {
    const Layer slab(2);
    Points points;
    points.tf = absorbing({0, 0, 0});
    points.at = {slab.at(1), slab.at(0.2), slab.at(0)};
    const MeanRadiance mean_radiance = points(slab.volume);
    EXPECT_NEAR(mean_radiance.mean[0][1], exponential_integral_2(1), 4 * mean_radiance.error[0]);
    EXPECT_NEAR(mean_radiance.mean[1][1], (exponential_integral_2(0.2) + exponential_integral_2(1.8)) / 2,
                4 * mean_radiance.error[1]);
    EXPECT_NEAR(mean_radiance.mean[2][1], (1 + exponential_integral_2(2)) / 2, 4 * mean_radiance.error[2]);
    EXPECT_LT(mean_radiance.error[0], 0.004);
}

// The border of a half space under even light. What it sends back is 1 - √(1-a) H(μ) (Chandrasekhar 1950), and
// ∫ H dμ = 2 / (1 + √(1-a)); half of all directions see that, half the light itself: J = 1 / (1 + √(1-a)).
TEST(MeanRadiance, BorderOfAHalfSpace) {
    const Layer deep(25);
    for (const double a : {0.5, 0.9, 0.99}) {
        Points points;
        points.tf = absorbing({a, a, a});
        points.at = {deep.at(0)};
        const MeanRadiance mean_radiance = points(deep.volume);
        EXPECT_NEAR(mean_radiance.mean[0][0], 1 / (1 + std::sqrt(1 - a)), 4 * mean_radiance.error[0]) << a;
        EXPECT_LT(mean_radiance.error[0], 0.004);
    }
}

TEST(MeanRadiance, BouncesAreHowOftenLightIsScatteredOnItsWay) {
    const Layer slab(2);
    Points points;
    points.tf = absorbing({1, 1, 1});
    points.at = {slab.at(1)};
    points.settings.scattering.bounces.most = 0;
    const MeanRadiance straight = points(slab.volume);
    EXPECT_NEAR(straight.mean[0][1], exponential_integral_2(1), 4 * straight.error[0]);
    double before = straight.mean[0][1];
    for (const int most : {1, 2, 5, 20}) {
        points.settings.scattering.bounces.most = most;
        const MeanRadiance mean_radiance = points(slab.volume);
        EXPECT_GT(mean_radiance.mean[0][1], before + 3 * mean_radiance.error[0]);
        before = mean_radiance.mean[0][1];
    }
    EXPECT_GT(before, 0.98);
    EXPECT_LE(before, 1);
}

TEST(MeanRadiance, ErrorFallsWithTheRootOfThePathsAndIsWhatSeedsDifferBy) {
    const Volume volume = small_shells();
    Points points;
    points.lighting.loaded_probe = builtin_probe("studio");
    for (int i = 0; i < 500; ++i) points.at.push_back({double(i * 7 % 19), double(i * 5 % 17), double(i % 16)});
    points.settings.reference.rays = 64;
    const MeanRadiance few = points(volume);
    points.settings.reference.rays = 256;
    const MeanRadiance many = points(volume);
    EXPECT_NEAR(few.render_statistics.paths.noise / many.render_statistics.paths.noise, 2, 0.1);
    points.settings.scattering.seed = 3;
    const MeanRadiance again = points(volume);
    double squares = 0, expected = 0;
    for (std::size_t i = 0; i < points.at.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            squares += std::pow(many.mean[i][c] - again.mean[i][c], 2);
            expected += std::pow(many.error[i], 2) + std::pow(again.error[i], 2);
        }
    EXPECT_NEAR(squares / expected, 1, 0.15);
}

TEST(MeanRadiance, EveryInstructionSetAndThreadCountGivesTheSameBits) {
    const Volume volume = small_shells();
    Points points;
    points.lighting.loaded_probe = builtin_probe("studio");
    points.settings.reference.rays = 40;
    points.settings.scattering.anisotropy = 0.3;
    for (int i = 0; i < 333; ++i) points.at.push_back({i * 0.06, i * 0.05, i * 0.045});
    points.device = Device::cpu(1, Isa::scalar);
    const MeanRadiance scalar = points(volume);
    for (const Isa isa : available_isas())
        for (const int threads : {1, 3}) {
            points.device = Device::cpu(threads, isa);
            const MeanRadiance mean_radiance = points(volume);
            EXPECT_EQ(mean_radiance.mean, scalar.mean) << name_of(isa) << ", " << threads << " threads";
            EXPECT_EQ(mean_radiance.error, scalar.error);
        }
}

TEST(MeanRadiance, StopsAtErrorOrTimeAndWhenCancelled) {
    const Volume volume = small_shells();
    Points points;
    points.at = {{9.5, 8.5, 8}, {3, 4, 5}};
    points.settings.reference.rays = 65536;
    points.settings.reference.error = 0.01;
    const MeanRadiance sure = points(volume);
    EXPECT_TRUE(sure.render_statistics.complete);
    EXPECT_LE(sure.render_statistics.paths.relative_noise, 0.01);
    points.settings.reference.error.reset();
    points.settings.reference.time_s = 1e-4;
    EXPECT_LT(points(volume).render_statistics.paths.samples, 32);

    Progress cancelled;
    cancelled.cancel();
    const Medium medium = classify(upload(points.device, volume), points.tf, {});
    EXPECT_FALSE(trace_mean_radiance(points.device, medium, {}, {0, 0, 1}, points.at, points.settings, cancelled)
                     .render_statistics.complete);
    EXPECT_TRUE(trace_mean_radiance(points.device, medium, {}, {0, 0, 1}, {}, points.settings, cancelled).mean.empty());
}

TEST(MeanRadiance, IsAFieldOfThreeComponents) {
    Progress progress;
    Session session(tested_device());
    session.show(make_sample("ball", 16), progress);
    Scene scene;
    scene.volume = "sample:ball:16";
    scene.illumination.method = Method::reference;
    scene.illumination.reference.quantity = ReferenceQuantity::mean_radiance;
    scene.illumination.reference.rays = 64, scene.illumination.reference.subsample = 3;
    const Volume field = session.compute_field(scene, progress).volume;
    EXPECT_EQ(field.components, 3);
    EXPECT_EQ(field.dimensions, (std::array<int, 3>{6, 6, 6}));
    EXPECT_EQ(field.key_values.at("chiaro_field"), "fluence");
    EXPECT_EQ(field.key_values.at("chiaro_bounces"), "unlimited");
    const auto j = field.as<float>();
    EXPECT_LT(j[3 * ((2 * 6 + 2) * 6 + 2)], 0.9);  // in the ball
    EXPECT_GT(j[0], 0.8);                          // in a corner
    EXPECT_NEAR(field.geometry.spacing_mm.x, 3 * make_sample("ball", 16).geometry.spacing_mm.x, 1e-12);
    EXPECT_THROW(session.render(scene, progress), Error);
}
