// Slices, places on surfaces, values of regions and gradients: the library's answers, in messages.
#include <chiaro/measuring.h>
#include <chiaro/slice.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "jpeg.h"
#include "memory_budget.h"
#include "slice_look.h"
#include "view.h"

namespace chiaro::server {
namespace {

constexpr int largest_slice = 4096;
constexpr int max_values = 65536, max_panes = 16;
constexpr double farthest_mm = 1e12;
constexpr double least_slice_side = 0.35;  // of what is asked for, on a slow way
constexpr int gradient_columns = 256, gradient_rows = 128;

Vec3 vector_in(const Json& request, const char* name) {
    const auto found = request.find(name);
    const auto is_number = [](const Json& c) { return c.is_number() && std::abs(c.get<double>()) <= farthest_mm; };
    if (found == request.end() || !found->is_array() || found->size() != 3 ||
        !std::all_of(found->begin(), found->end(), is_number))
        throw Error(ErrorCode::usage, fmt::format("{}: must be three numbers of at most 1e12", name));
    return {(*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>()};
}

SlicePlane plane_in(const Json& request) {
    const Json& plane = object_in(request, "plane");
    SlicePlane told{vector_in(plane, "centre"), vector_in(plane, "right"), vector_in(plane, "down")};
    std::tie(told.width, told.height) = size_in(request, "size", largest_slice);
    return told;
}

SliceSampling sampling_in(const Json& request) {
    SliceSampling sampling = SliceSampling::linear;
    if (const std::string name = text_in(request, "sampling", ""); !name.empty()) from_text(name, sampling);
    return sampling;
}

/// Of the channel that is meant; the first where nothing is said.
Values values_in(const Json& request, const Session& session) {
    const std::vector<DeviceVolume> all = session.volumes();
    return {all[request.contains("channel") ? std::size_t(whole_in(request, "channel", 0, int(all.size()) - 1)) : 0],
            session.source()};
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

const std::shared_ptr<const Loaded>& opened(const std::shared_ptr<const Loaded>& loaded) {
    if (!loaded) throw Error(ErrorCode::usage, "no volume is open");
    return loaded;
}

/// The same place with fewer, larger pixels: `side` times as many along a row and a column.
SlicePlane with_side(SlicePlane plane, double side) {
    const int width = std::max(1, int(std::lround(plane.width * side)));
    const int height = std::max(1, int(std::lround(plane.height * side)));
    plane.right_mm = double(plane.width) / width * plane.right_mm;
    plane.down_mm = double(plane.height) / height * plane.down_mm;
    plane.width = width, plane.height = height;
    return plane;
}

Region region_in(const Json& request) {
    const std::string shape = text_in(request, "shape");
    if (shape == "ball") return BallRegion{vector_in(request, "centre"), number_in(request, "radius", 0, farthest_mm)};
    if (shape == "box") return BoxRegion{vector_in(request, "corner"), vector_in(request, "opposite")};
    throw Error(ErrorCode::usage, "shape: must be ball or box");
}

/// About how many voxels a region holds.
double voxels_in(const Region& region, const SourceLevel& grid) {
    const Geometry& g = grid.geometry;
    const auto [nx, ny, nz] = grid.dimensions;
    const double count = double(nx) * ny * nz;
    if (const auto* ball = std::get_if<BallRegion>(&region))
        return std::min(count, 4.2 * std::pow(ball->radius_mm, 3) / (g.spacing_mm.x * g.spacing_mm.y * g.spacing_mm.z));
    const BoxRegion& box = std::get<BoxRegion>(region);
    const Vec3 sides = g.voxel_from_world_vector(box.opposite_mm - box.corner_mm);
    return std::min(count, (std::abs(sides.x) + 1) * (std::abs(sides.y) + 1) * (std::abs(sides.z) + 1));
}

/// A pixel for each bin, the steepest gradients on top; 255 is the largest count, 0 none, between them by logarithm.
Image picture_of(const GradientHistogram& histogram) {
    const std::uint64_t most = *std::max_element(histogram.counts.begin(), histogram.counts.end());
    Image image{histogram.columns, histogram.rows, false, {}};
    image.pixels.resize(3 * histogram.counts.size());
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto count = histogram.counts[std::size_t(histogram.rows - 1 - y) * histogram.columns + x];
            const double shade = 255 * std::log1p(double(count)) / std::log1p(double(most));
            std::fill_n(&image.pixels[3 * (std::size_t(y) * image.width + x)], 3, std::uint8_t(std::lround(shade)));
        }
    return image;
}

}  // namespace

/// The request's part of a scene.
Scene View::slice_scene(const Json& request) const {
    Json own = Json::object();
    for (const char* key : {"transfer_function", "threshold", "channels", "labels"})
        if (request.contains(key) && !request[key].is_null()) own[key] = request[key];
    return scene_of(own);
}

/// A picture of a plane, as a frame; or its values, as numbers.
Json View::slice(const Json& request, Progress& progress) {
    const auto loaded = opened(shown());
    const SlicePlane plane = plane_in(request);
    const Session session = render_worker_.share_shown(*loaded);
    const Values values = values_in(request, session);
    if (flag_in(request, "values", false)) {
        if (plane.width * plane.height > max_values)
            throw Error(ErrorCode::usage, fmt::format("size: at most {} values at a time", max_values));
        Json numbers = Json::array();
        for (const double value : values.slice(plane, sampling_in(request), true, progress).values)
            numbers.push_back(number_or_null(value));
        return {{"values", std::move(numbers)}};
    }
    const SliceLook look = slice_look(request, slice_scene(request), session, progress);
    const Json header{{"n", request["id"]}, {"kind", "slice"}, {"stage", "final"}};
    const auto drawn = [&](const SlicePlane& of) { return look.drawn(values, of, sampling_in(request), progress); };
    PictureKind kind{{}, {}, !flag_in(request, "lossless", false)};
    if (request.contains("pane")) kind.pane = whole_in(request, "pane", 0, max_panes - 1);
    if (!kind.is_draft) {
        send_frame(header, drawn(plane), true, kind);
        return Json::object();
    }
    // One that would be under way for too long, noise most of all, is drawn again with fewer pixels.
    const LinkState link = frames_.link();
    Image image = drawn(plane);
    std::string encoded = encode_jpeg(image, jpeg_quality());
    if (const double fits = link.draft_bytes() / double(encoded.size()); link.is_slow() && fits < 1) {
        image = drawn(with_side(plane, std::max(least_slice_side, std::sqrt(fits))));
        encoded = encode_jpeg(image, jpeg_quality());
    }
    send_encoded(header, image, "jpeg", encoded, kind);
    return Json::object();
}

/// What is in a segmentation, as its table has it.
Json View::labels(const Json& request, Progress& progress) {
    const auto loaded = opened(shown());
    const Scene scene = slice_scene(request);
    const auto labels = render_worker_.share_shown(*loaded).labels(scene, progress);
    if (!labels) throw Error(ErrorCode::usage, "labels: the scene has none");
    Json list = Json::array();
    for (std::size_t i = 0; i < labels->labels.size(); ++i) {
        const Label& label = labels->labels[i];
        list.push_back({{"value", label.value},
                        {"name", label.name},
                        {"rgb", label.rgb},
                        {"tint", label.tint},
                        {"opacity", label.opacity},
                        {"show", label.show},
                        {"voxels", labels->counts[i]}});
    }
    return {{"labels", std::move(list)}, {"notes", labels->notes}};
}

/// Which label a place has.
Json View::label(const Json& request, Progress& progress) {
    const auto loaded = opened(shown());
    const Session session = render_worker_.share_shown(*loaded);
    const auto labels = session.labels(slice_scene(request), progress);
    if (!labels) throw Error(ErrorCode::usage, "labels: the scene has none");
    SlicePlane place{vector_in(request, "at")};
    place.width = place.height = 1;
    const Label& found = labels->labels[chiaro::slice(*labels, session.volume(), place).front()];
    return {{"value", found.value}, {"name", found.name}};
}

/// The place on the nearest half-value surface.
Json View::snap(const Json& request, Progress&) {
    const auto loaded = opened(shown());
    const Vec3 at = vector_in(request, "at");
    std::optional<Vec3> normal;
    if (request.contains("normal") && !request["normal"].is_null()) normal = vector_in(request, "normal");
    const auto [volume, source] = values_in(request, render_worker_.share_shown(*loaded));
    const double reach_mm = number_in(request, "reach_mm", 0, farthest_mm);
    const auto on =
        source ? snap_to_surface(*source, volume, at, reach_mm, normal) : snap_to_surface(volume, at, reach_mm, normal);
    if (!on) return {{"hit", false}};
    return {{"hit", true}, {"at", json_of(*on)}};
}

/// The values of a ball or box.
Json View::region(const Json& request, Progress& progress) {
    const auto loaded = opened(shown());
    const Session session = render_worker_.share_shown(*loaded);
    const auto [volume, source] = values_in(request, session);
    const Region region = region_in(request);
    check_memory(24 * voxels_in(region, session.finest()));
    const RegionValues told =
        source ? chiaro::measure(*source, volume, region, progress) : chiaro::measure(volume, region, progress);
    Json percentiles = Json::object();
    for (std::size_t i = 0; i < told.shares.size(); ++i)
        percentiles[fmt::format("{}", std::lround(100 * told.shares[i]))] = told.percentiles[i];
    return {{"count", told.count},
            {"mean", told.mean},
            {"deviation", told.deviation ? Json(*told.deviation) : Json()},
            {"min", told.min},
            {"max", told.max},
            {"percentiles", percentiles},
            {"histogram", told.histogram},
            {"volume_mm3", told.volume_mm3},
            {"exact_mm3", told.exact_mm3}};
}

/// How often values and gradients come together: found once for a volume, of its first moment as all that is told of
/// its values.
Json View::gradients(const Json& request, Progress& progress) {
    const auto loaded = opened(shown());
    if (gradients_.of.lock() != loaded) {
        const GradientHistogram told =
            gradient_histogram(loaded->session.volume(), gradient_columns, gradient_rows, progress);
        gradients_ = {
            loaded, {{"values", {told.value_low, told.value_high}}, {"steepest", told.steepest}}, picture_of(told)};
    }
    send_frame({{"n", request["id"]}, {"kind", "gradients"}, {"stage", "final"}}, gradients_.counts, true);
    return gradients_.answer;
}

}  // namespace chiaro::server
