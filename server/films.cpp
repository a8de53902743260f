// Films of a page's keyframes: the scene of a frame, and the whole as a file.
#include <chiaro/film.h>
#include <chiaro/video.h>
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <optional>

#include "view.h"

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

/// A tape archive (POSIX ustar): pictures one after the other, for whoever has no ffmpeg.
class TarWriter {
public:
    explicit TarWriter(const fs::path& file) : stream_(file, std::ios::binary) {}

    void add(const std::string& name, const std::string& bytes) {
        std::string head(512, '\0');
        const auto put = [&](std::size_t at, const std::string& text) {
            std::memcpy(&head[at], text.data(), text.size());
        };
        put(0, name), put(100, "0000644"), put(108, "0000000"), put(116, "0000000");
        put(124, fmt::format("{:011o}", bytes.size())), put(136, "00000000000"), put(148, "        "), put(156, "0");
        put(257, "ustar"), put(263, "00");
        unsigned sum = 0;
        for (const char c : head) sum += static_cast<unsigned char>(c);
        put(148, fmt::format("{:06o}", sum)), head[154] = '\0';
        const std::size_t rest = (512 - bytes.size() % 512) % 512;
        stream_ << head << bytes << std::string(rest, '\0');
        if (!stream_) throw Error(ErrorCode::output, "the film cannot be written: the disk is full");
    }
    void finish() {
        stream_ << std::string(1024, '\0');
        if (!stream_.flush()) throw Error(ErrorCode::output, "the film cannot be written: the disk is full");
    }

private:
    std::ofstream stream_;
};

std::string frame_name(int frame) { return fmt::format("frame-{:05}.png", frame); }

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

/// A page's film: of the volume that is shown, and of no file that it may not see.
Film View::film_of(const Json& request) const {
    const auto loaded = shown();
    if (!loaded) throw Error(ErrorCode::usage, "no volume is open");
    Json own = object_in(request, "film");
    if (own.contains("keys") && own["keys"].is_array())
        for (Json& key : own["keys"])
            if (key.is_object() && key.contains("scene") && key["scene"].is_object())
                key["scene"]["volume"] = volume_of(*loaded, key["scene"]);
    std::vector<std::string> ignored;
    Film film = parse_film(text_of(own), context_.folders.first(), {}, ignored);
    for (Keyframe& key : film.keys) context_.folders.confine(key.scene);
    return film;
}

/// What is seen at a time.
Json View::film_frame(const Json& request) {
    const Film film = film_of(request);
    const double seconds = number_in(request, "seconds", 0, 1e6);
    const SourceLevel grid = shown()->session.finest();
    const int count = frame_count(film);
    const int frame =
        int(std::clamp(std::floor((seconds - film.keys.front().seconds) * film.fps + 1e-6), 0.0, count - 1.0));
    const Scene scene = frame_of(film, grid.geometry, grid.dimensions, frame);
    return {{"scene", Json::parse(to_json(scene))}, {"frame", frame}, {"frames", count}};
}

/// What the frames depend on: who writes them, of what, and how.
std::string View::film_text(const Film& film) const {
    const std::string volume = shown()->source.volume;
    std::error_code none;
    const auto size = fs::file_size(volume, none);
    const auto written = fs::last_write_time(volume, none).time_since_epoch().count();
    std::string text = fmt::format("{} {} {} {} {} {} {} {}", CHIARO_VERSION, id_, volume, size, written, film.fps,
                                   film.width, film.height);
    for (const Keyframe& key : film.keys) text += fmt::format("\n{} {}", key.seconds, to_json(key.scene));
    return text;
}

/// Renders the frames that are not there yet.
void View::render_film(const Film& film, const fs::path& folder, Progress& progress) {
    const auto loaded = shown();
    const SourceLevel grid = loaded->session.finest();
    int moment = 0;
    std::optional<Session> session(loaded->session.share_volume());
    const int count = frame_count(film);
    for (int frame = 0; frame < count; ++frame) {
        progress.report("film", double(frame) / count);
        progress.check();
        const fs::path file = folder / frame_name(frame);
        if (fs::exists(file)) continue;
        Progress quiet([&](std::string_view, double) {
            if (progress.cancelled()) quiet.cancel();
        });
        const Scene scene = frame_of(film, grid.geometry, grid.dimensions, frame);
        if (scene.read.time != moment) session.emplace(session_at(*loaded, scene, quiet));
        moment = scene.read.time;
        write_png(session->render(scene, quiet), file, {{"chiaro", to_json(scene)}});
    }
}

/// Whether the page that asked is still there, and so wants no more of it itself.
bool View::is_connected(int connection) const {
    const std::lock_guard lock(mutex_);
    return socket_ && connection == connection_;
}

/// All frames, as a film by ffmpeg or as pictures in an archive. Where the page is gone before it is done the frames
/// stay: who asks for the same film again goes on from there.
Json View::export_film(const Json& request, Progress& progress) {
    const Film film = film_of(request);
    const std::string format = text_in(request, "format");
    const bool is_video = format == "mp4" || format == "webm";
    if (!is_video && format != "png")
        throw Error(ErrorCode::usage, fmt::format("format {}: must be mp4, webm or png", format));
    int connection = 0;
    {
        const std::lock_guard lock(mutex_);
        connection = connection_;
    }
    const fs::path frames = context_.films.folder_of(film_text(film));
    const fs::path file = context_.store.fresh(is_video ? "." + format : ".tar");
    try {
        render_film(film, frames, progress);
        const int count = frame_count(film);
        std::optional<VideoWriter> video;
        std::optional<TarWriter> pictures;
        is_video ? void(video.emplace(file, film.width, film.height, film.fps)) : void(pictures.emplace(file));
        for (int frame = 0; frame < count; ++frame) {
            progress.check();
            const fs::path picture = frames / frame_name(frame);
            video ? video->write(read_png(picture)) : pictures->add(frame_name(frame), bytes_of(picture));
        }
        video ? video->finish() : pictures->finish();
    } catch (const Error& error) {
        std::error_code ignored;
        fs::remove(file, ignored);
        if (error.code() != ErrorCode::interrupted || is_connected(connection)) context_.films.remove(frames);
        throw;
    }
    context_.films.remove(frames);
    const std::string name = is_video ? "film." + format : "film-frames.tar";
    const auto bytes = fs::file_size(file);
    const char* type = format == "mp4" ? "video/mp4" : is_video ? "video/webm" : "application/x-tar";
    return {{"url", context_.store.offer(file, type, name)}, {"name", name}, {"bytes", bytes}};
}

}  // namespace chiaro::server
