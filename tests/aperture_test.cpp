// Depth of field: the blur of a small thing against the disc that a thin lens makes of it.
#include <chiaro/error.h>

#include "classify/medium.h"
#include "fixtures.h"

using namespace chiaro;

namespace {

/// A small opaque ball in the middle of a volume of millimetres.
Volume dot() {
    const double c = 20;
    return chiaro::testing::sampled<std::uint8_t>({41, 41, 41}, [&](double x, double y, double z) {
        return 255 * std::clamp(2.5 - std::hypot(x - c, y - c, z - c), 0.0, 1.0);
    });
}

struct Blur {
    double mass = 0, variance = 0;  ///< of the opacity; pixels², along a row
};

Blur blur_of(const Frame& frame) {
    double sum = 0, x1 = 0, x2 = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const double alpha = frame.rgba[4 * (std::size_t(y) * frame.width + x) + 3];
            sum += alpha, x1 += alpha * x, x2 += alpha * x * x;
        }
    return {sum, x2 / sum - x1 * x1 / (sum * sum)};
}

struct Lens : ::testing::TestWithParam<Projection> {
    const Device device = chiaro::testing::tested_device();
    const Medium medium = classify(upload(device, dot()), solid(), {});
    static constexpr int size = 121;

    static TransferFunction solid() {
        TransferFunction tf;
        tf.points = {{100, {1, 1, 1}, 0}, {150, {1, 1, 1}, 1}};
        return tf;
    }

    /// From 120 mm away, in focus at `focus_mm`.
    CameraSettings camera(double aperture_mm, double focus_mm) const {
        CameraSettings camera;
        camera.projection = GetParam();
        camera.eye = Vec3{140, 20, 20}, camera.target = Vec3{20, 20, 20};
        camera.fov_deg = 20;
        camera.aperture_mm = aperture_mm, camera.focus_mm = focus_mm;
        return camera;
    }
    Frame cast(const CameraSettings& settings, bool by_paths, int rays = 1) const {
        const auto& volume = medium.data().volume;
        const Camera seen = make_camera(settings, volume.geometry(), volume.dimensions());
        Frame frame(size, size);
        Progress progress;
        IlluminationSettings paths{.method = Method::reference};
        paths.reference.rays = 64;
        const RaySettings sampling{.samples_per_pixel = rays};
        by_paths
            ? trace_paths(device, medium, {}, seen, sampling, paths, frame, progress)
            : raycast(device, medium, IlluminationField(), {.shading = Shading::none}, seen, sampling, frame, progress);
        return frame;
    }
};

}  // namespace

/// Of a point at depth d a lens of diameter A that is in focus at f makes a disc of A |1 - f/d| in the plane in focus
/// (orthographic: A |1 - d/f| where the point is), whose variance along a row is that of the sharp picture and a
/// sixteenth of its diameter squared.
TEST_P(Lens, BlursByItsDisc) {
    constexpr double distance = 120, aperture = 16;
    for (const bool by_paths : {false, true})
        for (const double focus : {60.0, 85.0, 200.0}) {
            const CameraSettings settings = camera(aperture, focus);
            const bool flat = GetParam() == Projection::orthographic;
            const auto& volume = medium.data().volume;
            const double half = make_camera(settings, volume.geometry(), volume.dimensions()).half_height;
            const double pixels_per_mm = size / (2 * half * (flat ? 1 : focus));
            const double disc = aperture * std::abs(1 - (flat ? distance / focus : focus / distance)) * pixels_per_mm;
            const Blur sharp = blur_of(cast(camera(0, focus), by_paths, 16)),
                       blurred = blur_of(cast(settings, by_paths));
            const double found = 4 * std::sqrt(blurred.variance - sharp.variance);
            EXPECT_NEAR(found, disc, 0.05 * disc) << (by_paths ? "paths, " : "rays, ") << focus;
            EXPECT_NEAR(blurred.mass, sharp.mass, 0.05 * sharp.mass) << "light is spread, not lost";
        }
}

TEST_P(Lens, IsSharpInFocusAndWithoutAnAperture) {
    const Blur sharp = blur_of(cast(camera(0, 120), false, 64)), focused = blur_of(cast(camera(16, 120), false));
    EXPECT_NEAR(focused.variance, sharp.variance, 0.1 * sharp.variance);
    EXPECT_EQ(cast(camera(0, 60), false).rgba, cast(camera(0, 120), false).rgba);
}

/// A wide lens needs rays that the bounds of one ray know nothing of.
TEST_P(Lens, RasterisedBoundsAreLeftAlone) {
    const CameraSettings settings = camera(30, 60);
    const auto& volume = medium.data().volume;
    const Camera seen = make_camera(settings, volume.geometry(), volume.dimensions());
    Frame box(size, size), raster(size, size);
    Progress progress;
    raycast(device, medium, IlluminationField(), {}, seen, {.ray_setup = RaySetup::box}, box, progress);
    raycast(device, medium, IlluminationField(), {}, seen, {.ray_setup = RaySetup::raster}, raster, progress);
    EXPECT_EQ(box.rgba, raster.rgba);
}

INSTANTIATE_TEST_SUITE_P(Projections, Lens, ::testing::Values(Projection::perspective, Projection::orthographic),
                         [](const auto& row) { return to_text(row.param); });

TEST(Aperture, IsRefusedForMaxima) {
    Scene scene = scene_of_volume("sample:ball:8");
    scene.camera.aperture_mm = 3;
    EXPECT_NO_THROW(check(scene, ErrorCode::usage));
    scene.mode = Mode::mip;
    try {
        check(scene, ErrorCode::usage);
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_NE(std::string(error.what()).find("no depth"), std::string::npos) << error.what();
    }
}
