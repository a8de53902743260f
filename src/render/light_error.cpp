#include <chiaro/comparison.h>
#include <chiaro/error.h>
#include <chiaro/pick.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "illumination/light_at.h"
#include "illumination/sh/directions.h"
#include "render/appearance.h"
#include "render/plainly_lit.h"

namespace chiaro {
namespace {

constexpr int paths = 1024, tries = 16;
constexpr std::size_t fewest_points = 16;
constexpr double edges_before = 2;

void check_measurable(const Scene& scene) {
    const IlluminationSettings& light = scene.illumination;
    const auto refuse = [](const char* why) { throw Error(ErrorCode::usage, fmt::format("not measured: {}", why)); };
    if (!is_lit(scene.mode)) refuse("a value of a whole ray has no place that could be lit");
    if (light.method == Method::none) refuse("without a lighting method all light arrives");
    if (is_path_traced(light)) refuse("the reference is what is measured against");
    if (light.method == Method::histogram && !light.histogram.effects.ao)
        refuse("without occlusion local histograms keep no light away");
}

/// The scene whose light is judged; its picture is of no use and small.
Scene to_be_measured(const Scene& scene) {
    Scene plain = plainly_lit(scene, scene.illumination.method);
    if (plain.illumination.method == Method::transport)
        plain.illumination.scattering.bounces = scene.illumination.scattering.bounces;
    plain.illumination.reference.quantity = ReferenceQuantity::obscurance;
    plain.sampling.classification = Classification::post;
    plain.sampling.samples_per_pixel = 1;
    plain.width = plain.height = 16;
    return plain;
}

/// In front of what contributes most to pixels drawn at random, in voxels: in the skin of dense matter light ends
/// within one voxel, and pictures look up outside it what falls on it.
std::vector<Vec3> visible_points(const Medium& medium, const Camera& camera, const Scene& scene, int wanted) {
    const Geometry& geometry = medium.data().volume.geometry();
    const auto before = [&](Vec3 seen) {
        const bool is_parallel = camera.projection == Projection::orthographic;
        const Vec3 along = is_parallel ? camera.forward : normalized(seen - camera.eye);
        return geometry.voxel_from_world(seen - edges_before * geometry.smallest_spacing_mm() * along);
    };
    RaySettings once = scene.sampling;
    once.samples_per_pixel = 1;
    std::vector<Vec3> points;
    constexpr double per_bit = 0x1p-53;
    for (int round = 0; round < tries && int(points.size()) < wanted; ++round) {
        std::vector<std::array<double, 2>> places;
        for (int i = round * wanted; i < (round + 1) * wanted; ++i)
            places.push_back({scene.width * per_bit * double(scrambled(2 * std::uint64_t(i)) >> 11),
                              scene.height * per_bit * double(scrambled(2 * std::uint64_t(i) + 1) >> 11)});
        for (const auto& found : pick(medium, camera, once, scene.width, scene.height, places))
            if (found && int(points.size()) < wanted) points.push_back(before(found->world_mm));
    }
    return points;
}

/// The ground truth's own noise is taken off each square; their mean is known as well as they scatter.
LightError judge(const std::vector<Rgb>& found, const MeanRadiance& ground_truth) {
    const auto n = double(found.size());
    double mean = 0, sum = 0, squares = 0, largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            mean += ground_truth.mean[i][c] / (3 * n);
            square += (found[i][c] - ground_truth.mean[i][c]) * (found[i][c] - ground_truth.mean[i][c]) / 3;
        }
        square -= ground_truth.error[i] * ground_truth.error[i];
        sum += square, squares += square * square;
        largest = std::max(largest, square);
    }
    const double mean_square = sum / n;
    const double half = 1.96 * std::sqrt(std::max(squares / n - mean_square * mean_square, 0.0) / (n - 1));
    const auto share = [&](double square) { return mean > 0 ? std::sqrt(std::max(square, 0.0)) / mean : 0; };
    return {
        int(found.size()), share(mean_square), {share(mean_square - half), share(mean_square + half)}, share(largest)};
}

}  // namespace

LightError measure_light(Session& session, const Scene& scene, Progress& progress, int points) {
    check_measurable(scene);
    const Scene plain = to_be_measured(scene);
    session.render(plain, progress);
    const DeviceVolume& volume = session.volume();
    const Medium& medium = session.medium();
    const Camera camera = make_camera(session.camera(), volume.geometry(), volume.dimensions());
    Lighting lighting = with_probe(plain.lighting);
    turn_by_frame(lighting.probe, volume.geometry().world);

    const std::vector<Vec3> seen = visible_points(medium, camera, scene, points);
    if (seen.size() < fewest_points) throw Error(ErrorCode::usage, "not measured: too little is seen");
    std::vector<Rgb> found = light_at(session.light(), lighting, camera, medium.data(), seen);
    if (!finds_light(plain.illumination)) {
        const Rgb mean = mean_radiance(lighting);
        for (Rgb& light : found)
            for (int c = 0; c < 3; ++c) light[c] *= mean[c];
    }
    IlluminationSettings reference = plain.illumination;
    reference.reference = {.rays = paths};
    const MeanRadiance ground_truth =
        trace_mean_radiance(volume.data().device, medium, lighting, camera.orbit_up, seen, reference, progress);
    progress.check();
    return judge(found, ground_truth);
}

}  // namespace chiaro
