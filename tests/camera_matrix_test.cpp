// Cameras of other programs, as matrices: the pictures of the same cameras of ours, tiles, and what is refused.
#include <chiaro/describe.h>
#include <chiaro/error.h>

#include <cstring>

#include "core/linear_system.h"
#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

using Rows = std::array<std::array<double, 4>, 4>;

Matrix4 product(const Rows& a, const Rows& b) {
    Matrix4 m{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t k = 0; k < 4; ++k) m[4 * i + j] += a[i][k] * b[k][j];
    return m;
}
Rows rows(const Matrix4& m) {
    Rows r{};
    for (std::size_t i = 0; i < 16; ++i) r[i / 4][i % 4] = m[i];
    return r;
}

/// World to the camera's axes: right, up, towards the viewer.
Rows look(const Camera& c) {
    const auto row = [&](Vec3 axis) { return std::array{axis.x, axis.y, axis.z, -dot(axis, c.eye)}; };
    return {row(c.right), row(c.up), row(-c.forward), {0, 0, 0, 1}};
}

/// As glFrustum and glOrtho; lengths of a perspective at distance 1.
Matrix4 matrix_of(const Camera& c, double l, double r, double b, double t, double near, double far) {
    const double w = r - l, h = t - b, d = far - near;
    if (c.projection == Projection::orthographic)
        return product({{{2 / w, 0, 0, -(r + l) / w},
                         {0, 2 / h, 0, -(t + b) / h},
                         {0, 0, -2 / d, -(far + near) / d},
                         {0, 0, 0, 1}}},
                       look(c));
    return product({{{2 / w, 0, (r + l) / w, 0},
                     {0, 2 / h, (t + b) / h, 0},
                     {0, 0, -(far + near) / d, -2 * far * near / d},
                     {0, 0, -1, 0}}},
                   look(c));
}

Matrix4 matrix_of(const Camera& c, int width, int height) {
    const double h = c.half_height, w = h * width / height;
    return matrix_of(c, -w, w, -h, h, 1, 500);
}

/// The part of a picture that clip coordinates x0 to x1, y0 to y1 show, as the whole of one.
Matrix4 tile(const Matrix4& m, double x0, double x1, double y0, double y1) {
    const double sx = 2 / (x1 - x0), sy = 2 / (y1 - y0);
    return product({{{sx, 0, 0, -sx * (x0 + x1) / 2}, {0, sy, 0, -sy * (y0 + y1) / 2}, {0, 0, 1, 0}, {0, 0, 0, 1}}},
                   rows(m));
}

Volume body() {
    Volume volume = sampled<float>(
        {40, 44, 48}, [](double x, double y, double z) { return shells(x, y, z, 44) * (x > 18 ? 1 : 0.6); });
    volume.geometry.spacing_mm = {1, 0.9, 1.2};
    volume.geometry.origin_mm = {-5, 10, 3};
    return volume;
}

CameraSettings of(Projection projection) {
    return {.azimuth_deg = 50, .elevation_deg = 20, .roll_deg = 15, .projection = projection};
}

struct CameraMatrix : ::testing::TestWithParam<Projection> {};

}  // namespace

TEST_P(CameraMatrix, OfOurOwnCameraMakesItsPicture) {
    const Volume volume = body();
    Shot shot;
    shot.lighting.shading = Shading::phong;
    shot.camera = of(GetParam());
    const Frame expected = shot(volume);
    Matrix4 m = matrix_of(make_camera(shot.camera, volume.geometry, volume.dimensions), shot.width, shot.height);
    for (double factor : {1.0, 3.0}) {  // homogeneous: the same camera
        for (double& entry : m) entry *= factor;
        shot.camera = {.matrix = m};
        EXPECT_GT(mean_alpha(expected), 0.05);
        EXPECT_LE(difference(shot(volume), expected, 1e-3).pixels_beyond, 30) << factor;
    }
}

// Off the axis: four tiles, which do not end at the same pixels as blocks do, are the picture. So with the bounds of
// what is visible, and the probe behind.
TEST_P(CameraMatrix, TilesAreThePicture) {
    const Volume volume = body();
    Shot shot;
    shot.lighting.probe = {.source = "sky", .background = GetParam() == Projection::perspective};
    shot.lighting.loaded_probe = load_probe("sky");
    shot.camera = of(GetParam());
    shot.width = 62, shot.height = 46;
    const Matrix4 m = matrix_of(make_camera(shot.camera, volume.geometry, volume.dimensions), shot.width, shot.height);
    const Frame whole = shot(volume);
    for (const RaySetup setup : {RaySetup::box, RaySetup::raster}) {
        shot.rays.ray_setup = setup;
        int beyond = 0;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                Shot part = shot;
                part.width /= 2, part.height /= 2;
                part.camera = {.up = shot.camera.up, .matrix = tile(m, i - 1, i, -j, 1 - j)};
                const Frame frame = part(volume);
                for (int y = 0; y < part.height; ++y)
                    for (int x = 0; x < part.width; ++x)
                        for (int c = 0; c < 4; ++c)
                            beyond += std::abs(frame.rgba[4 * std::size_t(y * part.width + x) + c] -
                                               whole.rgba[4 * std::size_t((y + j * part.height) * shot.width + x +
                                                                          i * part.width) +
                                                          c]) > 1e-3;
            }
        EXPECT_LE(beyond, 40);
    }
}

// A point of the world is seen in the pixel where the matrix has it: an opaque voxel, off the axis and stretched.
TEST_P(CameraMatrix, APointIsSeenWhereItSays) {
    Volume volume = sampled<std::uint8_t>(
        {21, 21, 21}, [](double x, double y, double z) { return x == 7 && y == 12 && z == 4 ? 255 : 0; });
    volume.geometry.spacing_mm = {2, 1, 1};
    Shot shot;
    shot.tf.points = {{20, {1, 1, 1}, 0}, {21, {1, 1, 1}, 1}};
    shot.camera = of(GetParam());
    const Camera c = make_camera(shot.camera, volume.geometry, volume.dimensions);
    const double s = 3 * c.half_height;
    const Matrix4 m = matrix_of(c, -0.9 * s, 0.6 * s, -0.4 * s, 0.5 * s, 1, 500);
    const Vec3 p = volume.geometry.world_from_voxel({7, 12, 4});
    const auto row = [&](int r) { return m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3]; };
    const double column = (row(0) / row(3) + 1) / 2 * 200 - 0.5, line = (1 - row(1) / row(3)) / 2 * 160 - 0.5;
    shot.width = 200, shot.height = 160;
    shot.camera = {.matrix = m};
    const Frame frame = shot(volume);
    double x = 0, y = 0, mass = 0;
    for (int j = 0; j < 160; ++j)
        for (int i = 0; i < 200; ++i) {
            const double alpha = frame.rgba[4 * (std::size_t(j) * 200 + i) + 3];
            x += alpha * i, y += alpha * j, mass += alpha;
        }
    ASSERT_GT(mass, 5);
    EXPECT_NEAR(x / mass, column, 0.3);
    EXPECT_NEAR(y / mass, line, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Both, CameraMatrix, ::testing::Values(Projection::perspective, Projection::orthographic),
                         [](const auto& test) {
                             return test.param == Projection::perspective ? "perspective" : "orthographic";
                         });

TEST(CameraMatrix, ScenesKeepItAndTurnsPutItAway) {
    Scene scene;
    scene.volume = "sample:ball";
    scene.camera.matrix = {0.5, 0, 0, 1, 0, 0.25, 0, 2.125, 0, 0, -0.125, 0, 0, 0, 0, 1};
    std::vector<std::string> unknown;
    Scene again = parse_scene(to_json(scene), "", "", unknown);
    EXPECT_EQ(again.camera, scene.camera);
    EXPECT_TRUE(unknown.empty());
    const auto written = [](std::string_view name, std::string_view) { return std::string(name); };
    set_by_name(again, {{"azimuth", "40"}}, written);
    EXPECT_FALSE(again.camera.matrix);
    set_by_name(again, {{"camera-matrix", to_text(scene.camera.matrix)}}, written);
    EXPECT_EQ(again.camera.matrix, scene.camera.matrix);
    EXPECT_THROW(set_by_name(again, {{"camera-matrix", "1,0,0,0"}}, written), Error);
}

TEST(CameraMatrix, WhatIsNoViewIsRefused) {
    const Volume volume = body();
    const Camera c = make_camera(of(Projection::perspective), volume.geometry, volume.dimensions);
    const Rows m = rows(matrix_of(c, 40, 30));
    const auto refusal = [](const Matrix4& matrix) {
        try {
            camera_of_matrix(matrix);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    EXPECT_EQ(refusal(product({}, m)),
              "the camera's matrix is singular: it leaves no way back from the picture to the world");
    EXPECT_EQ(refusal(product({{{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, m)),
              "the camera's matrix mirrors the picture");
    EXPECT_EQ(refusal(product({{{1, 0.2, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, m)),
              "the camera's matrix shears the picture: a view is a rectangle before the eye");
    Camera oblique = c;
    oblique.projection = Projection::orthographic;
    oblique.forward = normalized(c.forward + 0.3 * c.up);
    EXPECT_NE(refusal(matrix_of(oblique, -40, 40, -30, 30, 1, 500)), "none");
    EXPECT_EQ(refusal(product({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, m)), "none");
    EXPECT_THROW(make_camera({.eye = Vec3{1, 2, 3}, .target = Vec3{}, .matrix = product(m, m)}, volume.geometry,
                             volume.dimensions),
                 Error);
}
