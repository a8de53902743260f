// How sure the reference is: pixels that a few paths put far from the truth, and the time to a share of the light.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pathtrace/tracer.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

/// The scene as a picture shows it by default, as paths are drawn through it.
class Shown {
public:
    Shown(const Setup& setup, Scene scene) : device_(setup.device), progress_(setup.progress) {
        width_ = setup.quick ? 16 : 64, height_ = width_ * 3 / 4;
        scene.width = width_, scene.height = height_;
        Session session(device_);
        session.show(read_volume(scene, progress_), progress_);
        camera_ =
            make_camera(session.fit(scene, progress_), session.volume().geometry(), session.volume().dimensions());
        medium_ = classify(device_, session.volume(), session.resolve(scene.transfer), {}, progress_);
    }

    PathTracer tracer(const std::string& probe, bool surfaces) const {
        IlluminationSettings settings;
        settings.method = Method::reference;
        PathOptions options = path_options(settings);
        options.surfaces = surfaces;
        Lighting lighting;
        lighting.loaded_probe = builtin_probe(probe);
        return PathTracer(device_, medium_, lighting, camera_, {}, options, width_, height_);
    }
    void add(PathTracer& tracer, int samples) const {
        tracer.add(samples, progress_);
        progress_.check();
    }

private:
    const Device device_;
    Progress& progress_;
    int width_, height_;
    Camera camera_;
    Medium medium_;
};

/// Of one pixel, over the channels.
struct Estimate {
    double r, g, b, opacity;
    double standard_error;  ///< RMS of the channels'

    Estimate(const PixelSum& sum, int samples)
        : r(sum.r / samples), g(sum.g / samples), b(sum.b / samples), opacity(sum.a / samples) {
        const double variance = sum.squares / samples - (r * r + g * g + b * b) / 3;
        standard_error = std::sqrt(std::max(0., variance) / samples);
    }
    double mean() const { return (r + g + b) / 3; }
    double distance(const Estimate& o) const {
        return std::sqrt(((r - o.r) * (r - o.r) + (g - o.g) * (g - o.g) + (b - o.b) * (b - o.b)) / 3);
    }
    bool is_covered() const { return opacity > 0.5; }
};

/// After few paths against many, which go on from the few.
std::vector<Row> outliers(const Setup& setup, const Shown& shown, const std::string& name, const std::string& probe) {
    const int few = setup.quick ? 16 : 256, many = setup.quick ? 64 : 16384;
    PathTracer tracer = shown.tracer(probe, true);
    shown.add(tracer, few);
    const std::vector<PixelSum> early = tracer.sums();
    shown.add(tracer, many - few);
    double light = 0, worst = 0;
    int covered = 0, far = 0;
    for (std::size_t i = 0; i < early.size(); ++i) {
        const Estimate truth(tracer.sums()[i], many), found(early[i], few);
        if (!truth.is_covered()) continue;
        const double off = found.distance(truth);
        ++covered, light += truth.mean(), worst = std::max(worst, off);
        far += off > 8 * found.standard_error;
    }
    const std::string paths = fmt::format("{} paths a pixel against {}", few, many);
    return {
        {name + "/worst",
         "of the mean",
         spread_of({worst * covered / light}),
         {},
         {},
         paths + ": the pixel farthest off, over the mean of covered pixels; asked: at most 10"},
        {name + "/outliers",
         "%",
         spread_of({100. * far / covered}),
         {},
         {},
         fmt::format("of {} covered pixels are off by more than 8 of their own standard errors; asked: less than .1",
                     covered)}};
}

/// What a few paths foretell of a relative standard error of 2 % over covered pixels.
struct Effort {
    double path = 0;      ///< core-seconds of one a pixel
    double variance = 0;  ///< of one path, over the square of the light
    double seconds() const { return path * variance / (0.02 * 0.02); }
};

Effort effort(const Setup& setup, const Shown& shown, bool surfaces) {
    const int samples = setup.quick ? 16 : 256;
    std::vector<PixelSum> sums;
    const double seconds = cpu_seconds([&] {
        PathTracer tracer = shown.tracer("sky", surfaces);
        shown.add(tracer, samples);
        sums = tracer.sums();
    });
    double variance = 0, light = 0;
    for (const PixelSum& sum : sums) {
        const Estimate pixel(sum, samples);
        if (!pixel.is_covered()) continue;
        variance += pixel.standard_error * pixel.standard_error * samples;
        light += (pixel.r * pixel.r + pixel.g * pixel.g + pixel.b * pixel.b) / 3;
    }
    return {seconds / samples, variance / light};
}

std::vector<Row> with_surfaces(const Setup& setup, const Shown& shown, const std::string& name) {
    Effort surfaces, particles;
    const auto series = in_turns(setup.runs, {[&] { return (surfaces = effort(setup, shown, true)).seconds(); },
                                              [&] { return (particles = effort(setup, shown, false)).seconds(); }});
    return {{name, "core-s", spread_of(series[0]), median_ratio(series[0], series[1]),
             "with surfaces / particles alone",
             fmt::format("to a standard error of 2 % over covered pixels, sky; asked: at most 1.3; a path costs {:.2f} "
                         "times as much, its variance is {:.2f} times as large",
                         surfaces.path / particles.path, surfaces.variance / particles.variance)}};
}

std::optional<Scene> scene_of(const Setup& setup, const std::string& name) {
    Scene scene;
    if (name == "brain") {
        const auto file = real_file(setup.data, "brain_mri.nii.gz");
        if (!file) return std::nullopt;
        scene.volume = file->string();
    } else {
        scene.volume = "sample:" + name + (setup.quick ? ":32" : ":128");
        if (name == "cornell") scene.camera.azimuth_deg = 270, scene.camera.elevation_deg = 0;
    }
    return scene;
}

}  // namespace

std::vector<Case> path_noise_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const std::string volume : {"tubes", "cornell", "brain"}) {
        const auto scene = scene_of(setup, volume);
        const Shared<Shown> shown([&setup, scene] { return Shown(setup, *scene); });
        const auto add = [&](std::vector<std::string> names, const std::function<std::vector<Row>()>& rows) {
            cases.push_back({names, [names, rows, has_data = bool(scene)]() -> std::vector<Row> {
                                 if (has_data) return rows();
                                 std::vector<Row> skipped;
                                 for (const auto& name : names) skipped.push_back({name, "", {}, {}, {}, no_data});
                                 return skipped;
                             }});
        };
        for (const std::string probe : {"sky", "studio"}) {
            const std::string name = fmt::format("path-noise/{}/{}", volume, probe);
            add({name + "/worst", name + "/outliers"},
                [&setup, shown, name, probe] { return outliers(setup, *shown, name, probe); });
        }
        if (const std::string name = fmt::format("path-noise/{}/two-percent", volume); volume != "cornell")
            add({name}, [&setup, shown, name] { return with_surfaces(setup, *shown, name); });
    }
    return cases;
}

}  // namespace chiaro::bench
