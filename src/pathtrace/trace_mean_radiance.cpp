#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "pathtrace/schedule.h"
#include "pathtrace/tracer.h"

namespace chiaro {
namespace {

/// Points as a frame of paths. A few points are repeated, so that there are paths for all lanes and threads; beyond
/// the last it begins again to fill the row.
class PointFrame {
public:
    static constexpr int width = 64, fewest = 4096;

    explicit PointFrame(std::span<const Vec3> points)
        : points_(points.size()), height_((int(std::max<std::size_t>(points_, fewest)) + width - 1) / width) {
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            const Vec3& p = points[pixel % points_];
            laid_out_.x.push_back(float(p.x)), laid_out_.y.push_back(float(p.y)), laid_out_.z.push_back(float(p.z));
        }
    }

    int height() const { return height_; }
    std::size_t pixels() const { return std::size_t(width) * height_; }
    const PathPoints& laid_out() const { return laid_out_; }
    /// Paths a pixel, so that no point has fewer.
    int samples_for(int paths) const {
        const auto copies = int(pixels() / points_);
        return (paths + copies - 1) / copies;
    }

    /// Mean and standard error at every point, from sums of `samples` paths a pixel.
    void gather(const std::vector<PixelSum>& sums, int samples, MeanRadiance& mean_radiance) const {
        mean_radiance.mean.resize(points_), mean_radiance.error.resize(points_);
        double errors = 0, light = 0;
        for (std::size_t i = 0; i < points_; ++i) {
            PixelSum sum;
            double n = 0;
            for (std::size_t pixel = i; pixel < pixels(); pixel += points_) {
                const PixelSum& more = sums[pixel];
                sum.r += more.r, sum.g += more.g, sum.b += more.b, sum.squares += more.squares, n += samples;
            }
            const Rgb mean{sum.r / n, sum.g / n, sum.b / n};
            const double square = (mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]) / 3;
            const double variance = n > 1 ? std::max(sum.squares / n - square, 0.0) / (n - 1) : 0;
            mean_radiance.mean[i] = mean, mean_radiance.error[i] = std::sqrt(variance);
            errors += variance, light += square;
        }
        mean_radiance.render_statistics.paths = {
            samples, std::sqrt(errors / double(points_)),
            light > 0 ? std::sqrt(errors / light) : std::numeric_limits<double>::infinity()};
    }

private:
    std::size_t points_;
    int height_;
    PathPoints laid_out_;
};

}  // namespace

MeanRadiance trace_mean_radiance(const Device& device, const Medium& medium, const Lighting& lighting, Vec3 orbit_up,
                                 std::span<const Vec3> points_voxel, const IlluminationSettings& settings,
                                 Progress& progress) {
    MeanRadiance mean_radiance;
    if (points_voxel.empty()) return mean_radiance;
    const PointFrame frame(points_voxel);
    const int wanted = frame.samples_for(settings.reference.rays);
    const PathSchedule schedule(settings.reference, wanted);
    Camera nowhere = make_camera({}, medium.data().volume.geometry(), medium.data().volume.dimensions());
    nowhere.orbit_up = orbit_up;
    PathTracer tracer(device, medium, lighting, nowhere, {}, path_options(settings), PointFrame::width, frame.height(),
                      frame.laid_out());
    RenderStatistics& render_statistics = mean_radiance.render_statistics;
    while (const int samples = schedule.next(render_statistics.paths)) {
        const int done = render_statistics.paths.samples;
        progress.report("paths", double(done) / wanted);
        render_statistics.complete = tracer.add(samples, progress);
        if (!render_statistics.complete) return mean_radiance;
        frame.gather(tracer.sums(), done + samples, mean_radiance);
        render_statistics.samples = tracer.collisions();
    }
    return mean_radiance;
}

}  // namespace chiaro
