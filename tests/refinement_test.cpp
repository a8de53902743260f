// Where the samples of a lit ray stand closer (raycast/refinement.h): on a skin that is thinner than a step.
#include <chiaro/text.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fixtures.h"
#include "raycast/views.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A ball of an edge of some three voxels in which a skin of a third of one lies over glassy matter.
Volume ball() {
    return sampled<std::uint8_t>({48, 46, 44}, [](double x, double y, double z) {
        return 200 / (1 + std::exp((std::hypot(x - 23.3, y - 22.8, z - 21.9) - 16.37) / 0.7));
    });
}
TransferFunction skin() {
    constexpr Rgb flesh{0.8, 0.6, 0.5}, glass{0.4, 0.6, 0.9};
    TransferFunction tf;
    tf.points = {{60, flesh, 0}, {85, flesh, 0.9}, {100, flesh, 0.9}, {120, glass, 0.04}, {255, glass, 0.04}};
    return tf;
}

/// Lit once; seen by a camera whose rays meet the skin anywhere within their steps.
class Subject {
public:
    explicit Subject(Method method, Interpolation interpolation = Interpolation::cubic)
        : medium_(classify(upload(device_, ball()), skin(), {.interpolation = interpolation})) {
        lighting_.loaded_probe = builtin_probe("sky");
        if (method == Method::none) return;
        const IlluminationSettings by{.method = method, .histogram = {.cache = "none"}};
        const auto keep = [this](IlluminationField finer) { field_ = std::move(finer); };
        illuminate(device_, medium_, prepare(medium_.data().volume, by, progress_), lighting_, by, keep, progress_);
    }

    struct Seen {
        Frame frame;
        std::uint64_t samples;
    };
    Seen seen(const RaySettings& rays = {}, const Device& device = tested_device()) {
        Seen seen{Frame(90, 90), 0};
        const DeviceVolume::Data& volume = medium_.data().volume.data();
        const Camera camera =
            make_camera({.azimuth_deg = 37, .elevation_deg = 21, .zoom = 1.3}, volume.geometry, volume.dimensions);
        seen.samples = raycast(device, medium_, field_, lighting_, camera, rays, seen.frame, progress_).samples;
        return seen;
    }

private:
    Device device_ = tested_device();
    Progress progress_;
    Lighting lighting_{.specular = 0, .probe = {.source = "sky"}};
    Medium medium_;
    IlluminationField field_;
};

constexpr Method lit[] = {Method::spao, Method::visibility, Method::transport, Method::histogram};

double rms(const Frame& a, const Frame& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) squares += std::pow(double(a.rgba[i]) - b.rgba[i], 2);
    return std::sqrt(squares / double(a.rgba.size()));
}

TEST(Refinement, OnsetsTellTheWayToTheNearestValueThatShowsNothing) {
    std::vector<kernel::Rgba> steps;
    for (const float alpha : {0.0f, 0.3f, 0.5f, 0.2f, 0.1f, 0.1f, 0.0f, 0.4f}) steps.push_back({0, 0, 0, alpha});
    steps[3].g = 0.2f, steps[4].g = 0.5f;  // a colour that changes more than its opacity counts
    const std::vector<float> right{0, 0.3f, 0.5f, 0.8f, 0.6f, 0.1f, 0, 0.4f}, found = onset_table(steps);
    ASSERT_EQ(found.size(), right.size());
    for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(found[i], right[i], 1e-6) << i;
}

// Between steps of half a voxel and of a sixteenth; drafts, which are linear, are not refined.
TEST(Refinement, AThinSkinLooksTheSameWhereverSamplesLie) {
    for (const Method method : lit) {
        const auto error = [&](Interpolation interpolation) {
            Subject subject(method, interpolation);
            return rms(subject.seen().frame, subject.seen({.step_voxels = 1.0 / 16}).frame);
        };
        const double refined = error(Interpolation::cubic), draft = error(Interpolation::linear);
        if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {:.4f} for {:.4f}\n", to_text(method), refined, draft);
        EXPECT_LT(refined, 0.25 * draft) << to_text(method);
        EXPECT_LT(refined, 0.002) << to_text(method);
    }
}

TEST(Refinement, TakesSamplesWhereThereIsLightAndASpline) {
    EXPECT_EQ(Subject(Method::spao, Interpolation::linear).seen().samples,
              Subject(Method::none, Interpolation::linear).seen().samples);
    const auto plain = double(Subject(Method::none).seen().samples),
               refined = double(Subject(Method::spao).seen().samples);
    if (std::getenv("CHIARO_SHOW")) fmt::print("{:.2f} of the samples\n", refined / plain);
    EXPECT_GT(refined, 1.1 * plain);
    EXPECT_LT(refined, 2 * plain);
}

TEST(Refinement, SkippingThreadsAndInstructionSetsChangeNoBit) {
    for (const Method method : lit) {
        Subject subject(method);
        for (const auto classification : {Classification::post, Classification::pre, Classification::preintegrated})
            for (const auto compositing : {Compositing::front_to_back, Compositing::back_to_front}) {
                RaySettings rays{.classification = classification, .compositing = compositing};
                const Frame seen = subject.seen(rays).frame;
                EXPECT_EQ(subject.seen(rays, Device::cpu(1, Isa::scalar)).frame.rgba, seen.rgba)
                    << to_text(method) << to_text(classification);
                rays.skip_empty = false;
                EXPECT_EQ(subject.seen(rays).frame.rgba, seen.rgba) << to_text(method) << to_text(classification);
            }
    }
}

// Steps that are refined and those that are not cover each point of a ray once: matter is as opaque as by small steps.
TEST(Refinement, NothingIsCountedTwice) {
    Subject subject(Method::spao);
    for (const auto compositing : {Compositing::front_to_back, Compositing::back_to_front}) {
        RaySettings rays{.compositing = compositing, .early_termination = 0};
        const double coarse = mean_alpha(subject.seen(rays).frame);
        rays.step_voxels = 1.0 / 16;
        const double fine = mean_alpha(subject.seen(rays).frame);
        if (std::getenv("CHIARO_SHOW")) fmt::print("{:.5f} for {:.5f}\n", coarse, fine);
        EXPECT_NEAR(coarse, fine, 0.002 * fine);
    }
}

}  // namespace
