// The answers that take no time.
#include <chiaro/pick.h>
#include <fmt/format.h>

#include "command_line.h"
#include "core/user_cache.h"
#include "view.h"

namespace chiaro::server {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t largest_json = 4 << 20;  ///< parsed it takes some forty times as much

/// The scene that a picture carries; nothing where it carries none.
std::string carried_scene(const Metadata& metadata) {
    for (const auto& [key, text] : metadata)
        if (key == "chiaro") return text;
    return {};
}

}  // namespace

/// What the view is restored with, where the picture stays as it is.
Json View::keep(const Json& request) {
    const Scene scene = scene_of(object_in(request, "scene"));
    {
        const std::lock_guard lock(mutex_);
        state_ = request["scene"];
        if (request.contains("undo")) undo_ = object_in(request, "undo");
    }
    note_state();
    if (context_.changed) context_.changed(scene);
    return Json::object();
}

/// What another view of this user's looked like when it was seen last.
Json View::earlier(const Json& request) {
    const auto loaded = shown();
    const std::string view = text_in(request, "view");
    const auto other = loaded ? context_.kept.newest_of(loaded->source.volume, id_) : std::nullopt;
    if (!other || other->view != view) throw Error(ErrorCode::usage, "view: nothing is kept of it");
    return {{"scene", scene_json(scene_of(other->scene), loaded->session)}, {"undo", other->undo}};
}

/// What was sent of a volume, or all of it.
Json View::discard(const Json& request) {
    context_.uploads.discard(id_ + "/" + text_in(request, "uploaded"));
    return Json::object();
}

/// Whether a volume may be sent: told before its bytes are on their way.
Json View::room(const Json& request) {
    context_.uploads.check_room(std::uint64_t(number_in(request, "bytes", 0, 1e15)),
                                std::uint64_t(number_in(request, "files", 0, 1e9)));
    return Json::object();
}

Json View::ping(const Json&) { return Json::object(); }

/// What local histograms take on disk.
Json View::cache(const Json& request) {
    const bool is_cleared = flag_in(request, "clear", false);
    const fs::path folder = user_cache();
    std::uintmax_t bytes = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        if (entry.path().extension() != histograms_ending) continue;
        is_cleared ? fs::remove(entry.path(), ignored) : bytes += entry.file_size(ignored);
    }
    return {{"folder", folder.string()}, {"bytes", bytes}};
}

Json View::cancel(const Json& request) {
    const auto found = request.find("re");
    if (found == request.end()) throw Error(ErrorCode::usage, "re: must name a request");
    const std::lock_guard lock(mutex_);
    if (const auto running = running_.find(key_of(*found)); running != running_.end()) running->second->cancel();
    if (*found == "open") context_.first.cancel();  // another view that waits for it reads it itself
    return Json::object();
}

Json View::pick(const Json& request) {
    const double x = number_in(request, "x", -1e5, 1e5), y = number_in(request, "y", -1e5, 1e5);
    const auto seen = render_worker_.last_frame();
    if (!seen) return {{"hit", false}};
    const auto found = chiaro::pick(seen->medium, seen->camera, seen->rays, seen->width, seen->height, x, y);
    if (!found) return {{"hit", false}, {"n", seen->n}};
    return {{"hit", true},
            {"n", seen->n},
            {"value", found->value},
            {"voxel", json_of(seen->finest.voxel_from_world(found->world_mm))},
            {"world_mm", json_of(found->world_mm)},
            {"opacity", found->opacity},
            {"rgb", found->rgb},
            {"share", found->weight / found->covered},
            {"depth_mm", found->depth_mm}};
}

Json View::command(const Json& request) {
    const Scene scene = scene_of(object_in(request, "scene"));
    // Points that are a preset's own are told by its name.
    std::string named;
    if (scene.transfer.points && !scene.transfer.points->name.empty()) {
        TransferSettings settings;
        settings.source = scene.transfer.points->name;
        try {
            if (shown()->session.resolve(settings) == *scene.transfer.points) named = settings.source;
        } catch (const Error&) {  // no preset's name
        }
    }
    return {{"text", command_line(scene, named, text_in(request, "output", "picture.png"))}};
}

Json View::resolve(const Json& request) {
    const Scene scene = scene_of({{"transfer_function", object_in(request, "transfer_function")}});
    return {{"transfer_function", Json::parse(to_json(shown()->session.resolve(scene.transfer)))}};
}

Json View::export_text(const Json& request) {
    const std::string what = text_in(request, "what");
    Scene scene = scene_of(object_in(request, "scene"));
    if (what == "transfer")
        return {{"text", to_json(shown()->session.resolve(scene.transfer))}, {"name", "transfer.json"}};
    Lighting lighting = scene.lighting;
    if (!lighting.probe.source.empty()) lighting.loaded_probe = load_probe(lighting);
    scene.lighting.probe.exposure = exposure_stops(lighting);  // files remember the number
    if (what == "scene") return {{"text", scene_json(scene, shown()->session).dump(2) + "\n"}, {"name", "scene.json"}};
    throw Error(ErrorCode::usage, "what: must be transfer or scene");
}

Json View::import_text(const Json& request) { return take_file(text_in(request, "name"), text_in(request, "text")); }

Json View::take_file(const std::string& name, const std::string& bytes) {
    const fs::path file = context_.store.keep(name, bytes);
    const std::string ending = fs::path(name).extension().string();
    std::string scene;
    if (ending == ".png" || ending == ".exr") {
        scene = carried_scene(ending == ".png" ? read_png_metadata(file) : read_exr_metadata(file));
        if (scene.empty() && ending == ".png")
            throw Error(ErrorCode::input, fmt::format("{}: this picture carries no scene", name));
    }
    if (scene.empty() && (ending == ".hdr" || ending == ".exr")) {
        load_probe(file.string());  // throws what is wrong with it
        return {{"kind", "probe"}, {"source", file.string()}};
    }
    if (ending == ".json") {
        if (bytes.size() > largest_json)
            throw Error(ErrorCode::input,
                        fmt::format("{}: a JSON file may have at most {} MiB", name, largest_json >> 20));
        const Json json = parse_message(bytes);
        if (json.contains("volume") || json.contains("camera") || json.contains("lighting")) scene = bytes;
    }
    return scene.empty() ? file_as_transfer(file) : file_as_scene(scene, name);
}

Json View::file_as_scene(const std::string& text, const std::string& name) {
    const Json json = parse_message(text);
    std::vector<std::string> unknown;
    Json wanted;
    if (json.contains("volume") && json["volume"].is_object()) wanted = text_in(json["volume"], "file", "");
    try {
        const Scene scene = scene_of(json, &unknown);
        const bool is_other =
            wanted.is_string() && fs::path(wanted.get<std::string>()).filename() != fs::path(scene.volume).filename();
        return {{"kind", "scene"},
                {"scene", scene_json(scene, shown()->session)},
                {"unknown", unknown},
                {"needs_volume", is_other ? wanted : Json()}};
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}", name, error.what()));
    }
}

Json View::file_as_transfer(const fs::path& file) {
    const auto loaded = shown();
    if (!loaded) throw Error(ErrorCode::usage, "no volume is open");
    TransferSettings settings;
    settings.source = file.string();
    return {{"kind", "transfer"}, {"transfer_function", Json::parse(to_json(loaded->session.resolve(settings)))}};
}

}  // namespace chiaro::server
