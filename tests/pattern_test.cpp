// How much of the grids of voxels and light is seen on a smooth ball. A convex, matte, even ball has one brightness for
// each direction of its surface: its picture is fitted by polynomials on the sphere and the light that is right, which
// bends sharply where a sun sets, and what is left over is pattern.
#include <chiaro/render.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "core/linear_system.h"
#include "illumination/probe/data.h"
#include "surface_subject.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int degree = 8;
constexpr double radius = 22.37;

/// x^i y^j and x^i y^j z of a unit vector.
std::vector<double> polynomials(double x, double y) {
    const double z = std::sqrt(1 - x * x - y * y);
    std::vector<double> values;
    for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j)
            for (int k = 0; k < 2 && i + j + k <= degree; ++k)
                values.push_back(std::pow(x, i) * std::pow(y, j) * (k ? z : 1));
    return values;
}

struct Pattern {
    double mean = 0, rms = 0, worst = 0;  ///< the last two over the mean
};

/// What a probe sends, green: its pixels that are much brighter than others each, all else in blocks.
class Environment {
public:
    explicit Environment(const Probe& probe) {
        const ProbeImage& image = probe.data().image;
        const int block = image.width % 8 + image.height % 8 ? 1 : 8, columns = image.width / block;
        double sum = 0;
        for (std::size_t i = 1; i < image.rgb.size(); i += 3) sum += image.rgb[i];
        const double bright = 8 * sum / (double(image.width) * image.height);
        std::vector<Vec3> blocks(std::size_t(columns * (image.height / block)), Vec3{0, 0, 0});
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double radiance = image.rgb[3 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) + 1];
                const Vec3 flux = radiance * image.solid_angle(y) * image.direction(x + 0.5, y + 0.5);
                Vec3& of_block = blocks[std::size_t(y / block * columns + x / block)];
                if (radiance > bright)
                    fluxes_.push_back(flux);
                else
                    of_block = of_block + flux;
            }
        fluxes_.insert(fluxes_.end(), blocks.begin(), blocks.end());
    }
    /// E of a normal.
    double on(Vec3 normal) const {
        double sum = 0;
        for (const Vec3& flux : fluxes_) sum += std::max(dot(normal, flux), 0.0);
        return sum;
    }

private:
    std::vector<Vec3> fluxes_;
};

/// `shade(x, y, u, v)`: of pixel (u, v), which sees the ball where its normal has the components x and y; `right(x,
/// y)`: what polynomials cannot follow, if that is not empty.
template <class Shade>
Pattern pattern_of(int pixels, double half_width, const Shade& shade,
                   const std::function<double(double, double)>& right = {}) {
    std::vector<std::vector<double>> basis;
    std::vector<double> seen;
    for (int v = 0; v < pixels; ++v)
        for (int u = 0; u < pixels; ++u) {
            const double x = ((u + 0.5) / pixels * 2 - 1) * half_width / radius,
                         y = (1 - (v + 0.5) / pixels * 2) * half_width / radius;
            if (x * x + y * y > 0.85 * 0.85) continue;
            basis.push_back(polynomials(x, y));
            if (right) basis.back().push_back(right(x, y));
            seen.push_back(shade(x, y, u, v));
        }
    const std::size_t size = basis[0].size();
    std::vector<std::vector<double>> normal(size, std::vector<double>(size, 0));
    std::vector<double> moments(size, 0);
    for (std::size_t p = 0; p < seen.size(); ++p)
        for (std::size_t i = 0; i < size; ++i) {
            moments[i] += basis[p][i] * seen[p];
            for (std::size_t j = 0; j < size; ++j) normal[i][j] += basis[p][i] * basis[p][j];
        }
    for (std::size_t i = 0; i < size; ++i) normal[i][i] *= 1 + 1e-12;
    const std::vector<double> fit = solve(normal, moments);
    Pattern pattern;
    double squares = 0;
    for (std::size_t p = 0; p < seen.size(); ++p) {
        double left = seen[p];
        for (std::size_t i = 0; i < size; ++i) left -= fit[i] * basis[p][i];
        pattern.mean += seen[p] / double(seen.size()), squares += left * left;
        pattern.worst = std::max(pattern.worst, std::abs(left));
    }
    pattern.rms = std::sqrt(squares / double(seen.size())) / pattern.mean, pattern.worst /= pattern.mean;
    return pattern;
}

Pattern pattern_on_ball(Method method, const std::string& probe, double edge, Mode mode, Vec3 normal) {
    constexpr int pixels = 160;
    const Device device = tested_device();
    const Look look{centre + 40 * normal, normal, normalized(cross(normal, {0.3, 1, 0.2})), radius, pixels};
    Lighting lighting = matte;
    lighting.probe.source = probe, lighting.loaded_probe = builtin_probe(probe);
    Shape shape;
    shape.mode = mode;
    if (mode == Mode::iso) shape.iso = {{100, Rgb{grey, grey, grey}}};
    const IlluminationSettings settings{.method = method, .histogram = {.cache = "none"}};
    const DeviceVolume volume = upload(device, ball(edge, radius));
    const Medium medium = classify(volume, skin(), shape);
    IlluminationField field;
    Progress progress;
    illuminate(
        device, medium, prepare(volume, settings, progress), lighting, settings,
        [&](IlluminationField finer) { field = std::move(finer); }, progress);
    Frame frame(pixels, pixels);
    raycast(device, medium, field, lighting, camera_of(look), {}, frame, progress);
    std::function<double(double, double)> right;
    if (probe == "sky")  // its sun is 4 degrees wide; other lamps set softly
        right = [environment = Environment(lighting.loaded_probe), axes = camera_of(look)](double x, double y) {
            return environment.on(x * axes.right + y * axes.up - std::sqrt(1 - x * x - y * y) * axes.forward);
        };
    const auto shade = [&](double, double, int u, int v) {
        return double(frame.rgba[4 * (std::size_t(v) * pixels + std::size_t(u)) + 1]);
    };
    return pattern_of(pixels, look.half_width, shade, right);
}

TEST(Pattern, OfLightThatAProbeSendsIsNone) {
    const Environment even(Probe(512, 256, std::vector<float>(512 * 256 * 3, 1))), sky(builtin_probe("sky"));
    for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{0.6, 0, -0.8}}) EXPECT_NEAR(even.on(normal), pi, 0.01);
    const auto right = [&](double x, double y) { return sky.on({std::sqrt(1 - x * x - y * y), x, y}); };
    const auto shade = [&](double x, double y, int, int) { return right(x, y); };
    EXPECT_LT(pattern_of(80, radius, shade, right).worst, 1e-5);
    EXPECT_GT(pattern_of(80, radius, shade).worst, 0.01);  // polynomials alone
}

TEST(Pattern, OfAnExactBallIsNone) {
    const Pattern lambert = pattern_of(160, radius, [](double x, double y, int, int) {
        return 0.3 + 0.5 * (0.36 * x + 0.48 * y + 0.8 * std::sqrt(1 - x * x - y * y));
    });
    EXPECT_LT(lambert.rms, 1e-5);
    const Pattern rings = pattern_of(
        160, radius, [](double x, double y, int, int) { return 1 + 0.01 * std::cos(40 * std::hypot(x, y)); });
    EXPECT_NEAR(rings.rms, 0.01 / std::sqrt(2.0), 1e-3);
}

void expect_none_seen(Method method, const std::vector<std::string>& probes, double worst) {
    for (const Mode mode : {Mode::dvr, Mode::iso})
        for (const double edge : {0.8, 2.0})
            for (const std::string& probe : probes) {
                const Pattern found = pattern_on_ball(method, probe, edge, mode, normalized(Vec3{0.5, -0.6, 0.4}));
                const std::string what = fmt::format("{} {} edge {} {}", to_text(method), to_text(mode), edge, probe);
                if (std::getenv("CHIARO_SHOW"))
                    fmt::print("{}: mean {:.3f}, {:.2f} %, worst {:.1f} %\n", what, found.mean, 100 * found.rms,
                               100 * found.worst);
                EXPECT_LT(found.rms, 0.005) << what;
                EXPECT_LT(found.worst, worst) << what;
            }
}

TEST(Pattern, OfVisibilityIsNotSeen) { expect_none_seen(Method::visibility, {"white", "sky", "studio"}, 0.02); }
TEST(Pattern, OfOcclusionIsNotSeen) { expect_none_seen(Method::spao, {"white"}, 0.02); }
TEST(Pattern, OfLocalHistogramsIsNotSeen) { expect_none_seen(Method::histogram, {"white"}, 0.03); }

}  // namespace
