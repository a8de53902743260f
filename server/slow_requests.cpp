// The answers that take time: each in a queue of its own, reporting and cancellable.
#include <chiaro/comparison.h>
#include <chiaro/probe.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <cmath>

#include "image/png.h"
#include "jpeg.h"
#include "memory_budget.h"
#include "overlay.h"
#include "view.h"

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr int largest_image = 16384, largest_look = 512, largest_comparison = 4096;

using Clock = std::chrono::steady_clock;
constexpr auto between_frames = std::chrono::milliseconds(500);  // of a comparison

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json figures_of(const MethodComparison& comparison) {
    const ImageDifference& distance = comparison.images.front().distance;
    const MethodReference& reference = comparison.references.front();
    return {{"rmse", number(distance.rmse)}, {"psnr", number(distance.psnr)},    {"ssim", number(distance.ssim)},
            {"max", number(distance.max)},   {"noise", number(reference.noise)}, {"paths", reference.paths}};
}

std::string stem_of(const std::string& volume) {
    const std::string name = volume.starts_with("sample:") ? volume.substr(7) : fs::path(volume).stem().string();
    std::string plain;
    for (const char c : name) plain += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '-';
    return plain.empty() ? "picture" : plain.substr(0, 60);
}

}  // namespace

Json View::folder(const Json& request, Progress&) { return context_.folders.list(text_in(request, "path", "")); }

/// Reads the scene's volume and shows it: anew, or with the state that the view has already, kept or put.
Json View::show(const Scene& scene, Progress& progress, int halvings, bool goes_on) {
    const auto loaded = context_.volumes.load(scene, progress, halvings);
    Json reply{{"volume", loaded->told}, {"scene", scene_json(scene, loaded->session)}};
    {
        const std::lock_guard lock(mutex_);
        shown_ = loaded;
        if (!goes_on) state_ = nullptr, undo_ = nullptr;
    }
    render_worker_.show(loaded);
    return reply;
}

Json View::open(const Json& request, Progress& progress) {
    if (flag_in(request, "half", false)) {
        const auto loaded = shown();
        if (!loaded) throw Error(ErrorCode::usage, "no volume is open");
        return show(loaded->source, progress, loaded->halvings + 1);
    }
    if (request.contains("uploaded"))
        return show(scene_of_volume(context_.uploads.to_open(id_ + "/" + text_in(request, "uploaded"))), progress);
    if (!request.contains("scene")) {
        return show(scene_of_volume(context_.folders.allowed_volume(text_in(request, "volume"))), progress);
    }
    std::vector<std::string> notes;
    Scene scene = read_scene(context_.folders.allowed(text_in(request, "scene")), context_.data, notes);
    scene.volume = context_.folders.allowed_volume(scene.volume);
    context_.folders.confine(scene);
    Json reply = show(scene, progress);
    reply["unknown"] = notes;
    return reply;
}

Json View::open_initial(const Json&, Progress& progress) {
    Json reply = show(*context_.initial, progress, 0, true);
    reply["type"] = "opened";
    std::unique_lock lock(mutex_);
    const Json state = state_, undo = undo_;
    lock.unlock();
    if (state.is_null()) return reply;
    reply["scene"] = scene_json(scene_of(state), shown()->session);
    reply["undo"] = undo;
    return reply;
}

/// The volume and the state of a view whose server was killed.
Json View::open_kept(const Json&, Progress& progress) {
    const KeptView kept = *kept_;
    Json reply = show(scene_of_volume(context_.folders.allowed_volume(kept.volume)), progress);
    reply["scene"] = scene_json(scene_of(kept.scene), shown()->session);
    reply["undo"] = kept.undo;
    reply["type"] = "opened";
    const std::lock_guard lock(mutex_);
    state_ = kept.scene, undo_ = kept.undo;
    return reply;
}

Json View::save(const Json& request, Progress& progress) {
    Scene scene = scene_of(object_in(request, "scene"));
    std::tie(scene.width, scene.height) = size_in(request, "size", largest_image);
    const std::string format = text_in(request, "format", "png");
    if (format != "png" && format != "exr")
        throw Error(ErrorCode::usage, fmt::format("format {}: must be png or exr", format));
    if (format == "exr" && scene.output.color == ColorMode::display)
        throw Error(ErrorCode::usage,
                    "format exr: colours mixed as display values give no linear light, which EXR holds");
    check_memory(28.0 * scene.width * scene.height);  // frame, picture and what encoding needs
    const std::vector<Overlay> overlays = overlays_in(request, scene.width, scene.height);
    // A session of its own: the page goes on with its.
    Session session = session_of(scene, progress);
    Image picture = session.render(scene, progress);
    scene = session.as_seen(std::move(scene));
    progress.report("write", 0);
    Metadata metadata;
    if (flag_in(request, "metadata", true)) metadata = {{"chiaro", to_json(scene)}};
    const fs::path file = context_.store.fresh("." + format);
    const auto draw_over = [&](auto& image) {
        for (const Overlay& overlay : overlays) draw(overlay, image);
    };
    if (format == "png") {
        draw_over(picture);
        write_png(picture, file, metadata, &progress);
    } else {
        Frame frame = expose(session.frame(), scene.output, &progress);
        draw_over(frame);
        write_exr(frame, file, metadata, &progress);
    }
    const std::string name = fmt::format("{}.{}", stem_of(scene.volume), format);
    const auto bytes = fs::file_size(file);
    const std::string url = context_.store.offer(file, format == "png" ? "image/png" : "image/x-exr", name);
    return {{"url", url}, {"name", name}, {"bytes", bytes}};
}

int View::jpeg_quality() const { return frames_.link().is_slow() ? far_quality : near_quality; }

void View::send_encoded(Json header, const Image& image, const char* type, const std::string& encoded,
                        PictureKind kind) {
    kind.request = header["n"].get<std::int64_t>();
    header["type"] = type;
    header["size"] = {image.width, image.height}, header["canvas"] = header["size"];
    frames_.post(frame_message(header, encoded), kind);
}

void View::send_frame(const Json& header, const Image& image, bool lossless, PictureKind kind) {
    if (lossless) return send_encoded(header, image, "png", as_text(encode_png(image)), kind);
    send_encoded(header, image, "jpeg", encode_jpeg(image, jpeg_quality()), kind);
}

/// A look on trial, by the ray caster alone.
Json View::look(const Json& request, Progress& progress) {
    Scene scene = scene_of(object_in(request, "scene"));
    std::tie(scene.width, scene.height) = size_in(request, "size", largest_look);
    scene.illumination.method = Method::none;
    scene.lighting.probe.background = false;
    scene.sampling.samples_per_pixel = 1;
    if (const auto loaded = shown(); loaded != side_shown_ || scene.read.time != side_moment_) {
        side_.reset(), side_shown_.reset();
        side_.emplace(session_of(scene, progress));
        side_shown_ = loaded, side_moment_ = scene.read.time;
    }
    const Image& image = side_->render(scene, progress);
    send_frame({{"n", request["id"]}, {"kind", "look"}, {"stage", "final"}}, image);
    return Json::object();
}

/// A light probe as it is, without exposure and rotation: the means over the pixels of a small equirectangular picture.
Json View::probe(const Json& request, Progress&) {
    const Scene scene = scene_of({{"probe", object_in(request, "probe")}});
    const Probe probe = scene.lighting.probe.source.empty() ? load_probe("white") : load_probe(scene.lighting);
    const auto [width, height] = size_in(request, "size", largest_look);
    Frame frame(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto span = [](int i, int n, int pixels) {
                const int from = int(std::int64_t(i) * pixels / n);
                return std::pair{from, std::max(from + 1, int(std::int64_t(i + 1) * pixels / n))};
            };
            const auto [x0, x1] = span(x, width, probe.width());
            const auto [y0, y1] = span(y, height, probe.height());
            float* out = &frame.rgba[4 * (std::size_t(y) * width + x)];
            for (int row = y0; row < y1; ++row)
                for (int column = x0; column < x1; ++column)
                    for (int c = 0; c < 3; ++c)
                        out[c] += probe.rgb()[3 * (std::size_t(row) * probe.width() + column) + c] /
                                  float((x1 - x0) * (y1 - y0));
            out[3] = 1;
        }
    send_frame({{"n", request["id"]}, {"kind", "probe"}, {"stage", "final"}}, develop(frame, {}));
    return Json::object();
}

/// The reference beside a method: the same picture again and again, as paths are added to it.
Json View::compare(const Json& request, Progress& progress) {
    Scene scene = scene_of(object_in(request, "scene"));
    std::tie(scene.width, scene.height) = size_in(request, "size", largest_comparison);
    Method method = scene.illumination.method;
    if (const std::string name = text_in(request, "method", ""); !name.empty()) from_text(name, method);
    Session session = session_of(scene, progress);
    bool is_first = true;
    const auto send = [&](const MethodComparison& so_far, const char* stage) {
        const Json figures = figures_of(so_far);
        const auto send_image = [&](const char* kind, const Frame& frame) {
            send_frame({{"n", request["id"]},
                        {"kind", kind},
                        {"stage", stage},
                        {"samples", so_far.references.front().paths},
                        {"figures", figures}},
                       develop(frame, scene.output));
        };
        if (std::exchange(is_first, false)) send_image("method", so_far.images.front().frame);
        send_image("reference", so_far.references.front().image.frame);
        return figures;
    };
    auto sent = Clock::now() - between_frames;
    const auto show = [&](const MethodComparison& so_far) {
        if (progress.cancelled() || Clock::now() - sent < between_frames) return;
        send(so_far, "accumulate");
        sent = Clock::now();
    };
    const MethodComparison all = compare_methods(session, scene, {method}, progress, show);
    progress.check();
    return {{"figures", send(all, "final")}};
}

/// "1.8 % from reference". In a session of its own: light on particles is not that of the picture.
Json View::measure(const Json& request, Progress& progress) {
    Scene scene = scene_of(object_in(request, "scene"));
    if (request.contains("size")) std::tie(scene.width, scene.height) = size_in(request, "size", largest_image);
    Session session = session_of(scene, progress);
    try {
        const LightError error = measure_light(session, scene, progress);
        return {{"percent", 100 * error.rmse},
                {"points", error.points},
                {"interval", {100 * error.interval[0], 100 * error.interval[1]}},
                {"largest", 100 * error.largest}};
    } catch (const Error& error) {
        if (error.code() != ErrorCode::usage) throw;
        return {{"percent", nullptr}, {"sentence", error.what()}};
    }
}

}  // namespace chiaro::server
