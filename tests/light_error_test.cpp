// "1.8 % from reference": that the figure is what a direct computation finds.
#include <chiaro/comparison.h>
#include <chiaro/pick.h>
#include <chiaro/samples.h>
#include <gtest/gtest.h>

#include <numbers>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A sample that a method lights.
struct Lit {
    Progress progress;
    Session session{tested_device()};
    Scene scene;

    explicit Lit(Method method, const std::string& sample = "shells", int size = 48) {
        scene.volume = "sample:" + sample;
        scene.width = 160, scene.height = 120;
        scene.interpolation = Interpolation::linear;  // where the error is well above the noise of the truth
        scene.illumination.method = method;
        scene.illumination.histogram.cache = "none";
        scene.illumination.visibility.storage = ShStorage::f32;
        session.show(make_sample(sample, size), progress);
    }
    LightError measured(int points = 1024) { return measure_light(session, scene, progress, points); }
};

double at(const Volume& field, const Vec3& p, int channel) {
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::array<int, 3> i;
        for (int a = 0; a < 3; ++a) {
            const double u = std::clamp(p[a], 0.0, field.dimensions[a] - 1.0);
            const int low = std::min(int(u), field.dimensions[a] - 2), up = corner >> a & 1;
            i[a] = low + up, weight *= up ? u - low : 1 - (u - low);
        }
        const auto place = (std::size_t(i[2]) * field.dimensions[1] + i[1]) * field.dimensions[0] + i[0];
        sum += weight * double(field.as<float>()[place * field.components + std::min(channel, field.components - 1)]);
    }
    return sum;
}

}  // namespace

TEST(LightError, IsWhatADirectComputationFinds) {
    for (const Method method : {Method::spao, Method::visibility}) {
        Lit subject(method);
        subject.scene.illumination.spao.normal_factor = 0;
        subject.scene.illumination.visibility.subsample = 1;
        subject.scene.illumination.visibility.model = VisibilityModel::paper;
        const LightError told = subject.measured();
        EXPECT_EQ(told.points, 1024);
        EXPECT_LT(told.interval[0], told.rmse);
        EXPECT_GT(told.interval[1], told.rmse);
        EXPECT_GT(told.largest, told.rmse);
        // What is seen through a regular net of pixels, against many paths.
        const Scene& scene = subject.scene;
        const Medium medium = subject.session.medium();
        const Camera camera = make_camera(subject.session.camera(), subject.session.volume().geometry(),
                                          subject.session.volume().dimensions());
        const Geometry& geometry = subject.session.volume().geometry();
        const auto before = [&](Vec3 seen) {  // two edges nearer to the eye
            return geometry.voxel_from_world(seen - 2 * geometry.spacing_mm.x * normalized(seen - camera.eye));
        };
        std::vector<Vec3> points;
        for (int y = 2; y < scene.height; y += 4)
            for (int x = 2; x < scene.width; x += 4)
                if (const auto seen = pick(medium, camera, scene.sampling, scene.width, scene.height, x, y))
                    points.push_back(before(seen->world_mm));
        ASSERT_GT(points.size(), 100u);
        IlluminationSettings settings{.method = Method::reference};
        settings.reference.rays = 4096, settings.scattering.bounces.most = 0;
        const MeanRadiance ground_truth =
            trace_mean_radiance(tested_device(), medium, {}, camera.orbit_up, points, settings, subject.progress);
        const Volume field = subject.session.compute_field(scene, subject.progress).volume;
        double squares = 0, mean = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            // V_00 of visibility in harmonics is √4π of the share.
            const double share =
                at(field, points[i], 0) / (method == Method::visibility ? std::sqrt(4 * std::numbers::pi) : 1);
            squares += std::pow(share - ground_truth.mean[i][0], 2), mean += ground_truth.mean[i][0];
        }
        const double direct = std::sqrt(squares / double(points.size())) / (mean / double(points.size()));
        EXPECT_NEAR(told.rmse, direct, 0.15 * direct);
    }
}

TEST(LightError, TransportIsJudgedByPathsWithItsBounces) {
    Lit subject(Method::transport, "fog", 32);
    subject.scene.illumination.transport = {.grid = 32, .directions = 24, .first_directions = 200, .error = 0.002};
    const LightError all = subject.measured();
    EXPECT_LT(all.rmse, 0.04);
    EXPECT_GT(all.rmse, 0);
    subject.scene.illumination.scattering.bounces.most = 0;
    EXPECT_LT(subject.measured().rmse, 0.04);
}

TEST(LightError, NoticesACoarserGrid) {
    Lit subject(Method::visibility, "fog", 48);
    subject.scene.illumination.visibility.subsample = 8;
    const double coarse = subject.measured().rmse;
    subject.scene.illumination.visibility.subsample = 1;
    EXPECT_LT(subject.measured().rmse, 0.7 * coarse) << "a finer grid is nearer";
}

TEST(LightError, IsTheSameForAnyNumberOfThreadsAndNoneInHaze) {
    Lit subject(Method::visibility, "ball", 24);
    Session one(Device::cpu(1));
    one.show(make_sample("ball", 24), subject.progress);
    EXPECT_EQ(measure_light(one, subject.scene, subject.progress, 300).rmse, subject.measured(300).rmse);
    subject.scene.transfer.points.emplace().points = {{0, {1, 0.5, 0.2}, 0}, {100, {1, 0.5, 0.2}, 0.0005}};
    EXPECT_LT(subject.measured().rmse, 0.002);
}

TEST(LightError, ExposureAndStrengthChangeNothing) {
    Lit subject(Method::visibility, "ball", 24);
    subject.scene.lighting.probe.source = "studio";
    const double before = subject.measured().rmse;
    EXPECT_GT(before, 0);
    subject.scene.lighting.probe.exposure = 2;
    EXPECT_NEAR(subject.measured().rmse, before, 1e-6);
    subject.scene.lighting.strength = 0.3;
    EXPECT_NEAR(subject.measured().rmse, before, 1e-6);
}

TEST(LightError, RefusesWhereNothingCouldBeWrong) {
    Lit subject(Method::none, "ball", 16);
    EXPECT_THROW(subject.measured(), Error);
    subject.scene.illumination.method = Method::reference;
    EXPECT_THROW(subject.measured(), Error);
    subject.scene.illumination.method = Method::spao;
    EXPECT_GT(subject.measured().rmse, 0);
    subject.scene.mode = Mode::mip;
    EXPECT_THROW(subject.measured(), Error);
    subject.scene.mode = Mode::iso;
    subject.scene.iso = {{50}};
    EXPECT_GT(subject.measured().points, 100);
    subject.scene.mode = Mode::dvr;
    subject.scene.transfer.opacity_scale = 0;
    EXPECT_THROW(subject.measured(), Error);
}
