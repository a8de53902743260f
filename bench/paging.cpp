// What a volume by bricks costs beside the same as a whole: a frame of which nothing is missing, and reading; and
// pictures of ever larger ones.
#include <chiaro/samples.h>
#include <chiaro/zarr.h>
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "child.h"
#include "classify/paged_medium.h"
#include "turntable.h"
#include "volume/bricks.h"
#include "volume/paged_level.h"

namespace chiaro::bench {
namespace {

constexpr int coarse_level = 1;  // stands for what is absent

/// A frame of a source's finest level, by bricks. All that it shows is there once `read` was called.
class PagedFrames {
public:
    PagedFrames(const Setup& setup, std::shared_ptr<const BrickSource> source)
        : setup_(setup),
          source_(std::move(source)),
          coarse_(upload(setup.device, read_level(*source_, coarse_level, setup.progress))),
          looks_(classify(setup.device, coarse_, transfer(source_->header().geometry), {}, setup.progress)),
          level_(source_, 0, coarse_, room()),
          medium_(paged_medium(level_, looks_)),
          camera_(camera_of(coarse_)),
          frame_(frame_of(setup)) {}

    /// Until nothing is missing; bricks a second, of those that were read, by `seconds` of each call.
    double read(double (*seconds)(const std::function<void()>&)) {
        double took = 0;
        for (;;) {
            level_.forget_seen();
            cast();
            const auto missing = level_.missing();
            setup_.progress.check();
            if (missing.empty()) return double(level_.bricks_read()) / took;
            took += seconds([&] { level_.read(missing, setup_.progress); });
        }
    }
    const Camera& camera() const { return camera_; }
    void cast() { raycast(setup_.device, medium_, {}, {}, camera_, {}, frame_, setup_.progress); }

    /// Of the same extinction at every level.
    static TransferFunction transfer(const Geometry& finest) {
        TransferFunction tf = sample_transfer_function("shells");
        tf.opacity_unit = finest.smallest_spacing_mm(), tf.opacity_unit_is_mm = true;
        return tf;
    }
    static Camera camera_of(const DeviceVolume& volume) {
        return make_camera(CameraSettings(), volume.geometry(), volume.dimensions());
    }
    static Frame frame_of(const Setup& setup) { return {setup.quick ? 128 : 1024, setup.quick ? 96 : 768}; }

private:
    std::int32_t room() const {
        std::int32_t bricks = 1;
        for (const int n : source_->levels()[0].dimensions) bricks *= brick_count(n);
        return bricks;
    }

    const Setup& setup_;
    std::shared_ptr<const BrickSource> source_;
    DeviceVolume coarse_;
    Medium looks_;
    PagedLevel level_;
    Medium medium_;
    Camera camera_;
    Frame frame_;
};

int size_of_volume(const Setup& setup) { return setup.quick ? 128 : 512; }

std::vector<Row> measure_frame(const Setup& setup, const std::string& name) {
    const int size = size_of_volume(setup);
    PagedFrames paged(setup, open_sample("shells", size));
    paged.read(cpu_seconds);
    const DeviceVolume volume = upload(setup.device, make_sample("shells", size));
    const Medium whole = classify(setup.device, volume, PagedFrames::transfer(volume.geometry()), {}, setup.progress);
    Frame frame = PagedFrames::frame_of(setup);
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * cpu_seconds([&] { paged.cast(); }); },
                                              [&] {
                                                  return 1e3 * cpu_seconds([&] {
                                                             raycast(setup.device, whole, {}, {}, paged.camera(), {},
                                                                     frame, setup.progress);
                                                         });
                                              }});
    return {{name, "ms/frame", spread_of(series[0]), median_ratio(series[0], series[1]), "the volume as a whole",
             "at most 1.3"}};
}

/// How fast the bricks that a picture shows are read from a file, beside the upload of the whole volume from memory.
std::vector<Row> measure_reading(const Setup& setup, const std::string& name, bool is_store) {
    const int size = size_of_volume(setup);
    const TemporaryFolder folder;
    const std::string raw = folder / fmt::format("shells_{0}x{0}x{0}_uint8.raw", size), store = folder / "shells.zarr";
    const Volume volume = make_sample("shells", size);
    std::ofstream(raw, std::ios::binary)
        .write(reinterpret_cast<const char*>(volume.voxels.data()), std::streamsize(volume.voxels.size()));
    if (is_store) write_zarr(*open_brick_source(raw, {}), store, {}, setup.progress);
    const auto seconds = is_store ? wall_seconds : cpu_seconds;  // other programs decode
    const double bricks = std::pow(brick_count(size), 3);
    const auto series =
        in_turns(setup.runs, {[&] {
                                  PagedFrames frames(setup, open_brick_source(is_store ? store : raw, {}));
                                  return frames.read(seconds);
                              },
                              [&] { return bricks / seconds([&] { upload(setup.device, volume); }); }});
    return {{name, is_store ? "bricks/s" : "bricks/s/core", spread_of(series[0]), median_ratio(series[0], series[1]),
             "upload from memory", is_store ? "zstd, by the clock" : "pread"}};
}

std::vector<int> picture_sizes(const Setup& setup) {
    return setup.quick ? std::vector{512, 1024} : std::vector{2048, 4096, 8192, 16384};
}

/// The program itself, from its start to the last picture, of ever larger volumes under the same budget: what it costs
/// must not grow with their size.
std::vector<Row> measure_pictures(const Setup& setup, const std::vector<std::string>& names) {
    const TemporaryFolder folder;
    const std::vector<int> sizes = picture_sizes(setup);
    std::vector<Measure> measures;
    for (const int size : sizes) {
        const std::vector<std::string> render{
            "render",    fmt::format("sample:shells:{}", size), "-o",     folder / "picture.png",
            "--memory",  setup.quick ? "64M" : "512M",          "--size", setup.quick ? "128x96" : "512x384",
            "--threads", std::to_string(setup.device.threads),  "--quiet"};
        measures.push_back([&setup, render] { return run_program(setup.tool, render); });
    }
    const auto series = in_turns(setup.runs, measures);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < sizes.size(); ++i)
        rows.push_back({names[i], "s of CPU time", spread_of(series[i]), median_ratio(series[i], series[0]),
                        fmt::format("{} voxels an axis", sizes[0])});
    return rows;
}

}  // namespace

std::vector<Case> paging_cases(const Setup& setup) {
    const std::string frame = "paging/frame", raw = "paging/bricks/raw", store = "paging/bricks/zarr";
    std::vector<std::string> pictures;
    for (const int size : picture_sizes(setup)) pictures.push_back(fmt::format("paging/picture/{}", size));
    return {{{frame}, [=, &setup] { return measure_frame(setup, frame); }},
            {{raw}, [=, &setup] { return measure_reading(setup, raw, false); }},
            {{store}, [=, &setup] { return measure_reading(setup, store, true); }},
            {pictures, [=, &setup] { return measure_pictures(setup, pictures); }}};
}

}  // namespace chiaro::bench
