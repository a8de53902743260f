#include <chiaro/film.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/file_contents.h"
#include "core/text.h"
#include "render/mixed_settings.h"
#include "render/scene_keys.h"

namespace chiaro {
namespace {

constexpr std::uintmax_t max_film_bytes = 64u << 20;

[[noreturn]] void refuse_film(const std::string& sentence) { throw Error(ErrorCode::input, "film: " + sentence); }

double film_number(const ReadJson& json, const char* name, double otherwise, double low, double high) {
    if (!json.contains(name)) return otherwise;
    const double value = json[name].is_number() ? json[name].get<double>() : NAN;
    if (!(value >= low && value <= high)) refuse_film(fmt::format("{}: must be {} to {}", name, low, high));
    return value;
}

ReadJson parse_film_json(const std::string& text) {
    if (is_deeper_than(34, text)) refuse_film("nested too deeply");
    try {
        return ReadJson::parse(text);
    } catch (const ReadJson::exception&) {
        refuse_film("must be JSON");
    }
}

void read_keys(const ReadJson& json, const std::filesystem::path& folder, const std::filesystem::path& data_folder,
               std::vector<std::string>& unknown_keys, Film& film) {
    if (!json.contains("keys") || !json["keys"].is_array() || json["keys"].empty() ||
        json["keys"].size() > max_keyframes)
        refuse_film(fmt::format("keys: must be a list of 1 to {}", max_keyframes));
    for (const ReadJson& key : json["keys"]) {
        const std::size_t i = film.keys.size();
        if (!key.is_object() || !key.contains("scene") || !key["scene"].is_object())
            refuse_film(fmt::format("keys[{}]: must be an object with at and scene", i));
        Keyframe made;
        made.seconds = film_number(key, "at", double(i), 0, 1e6);
        if (i > 0 && !(made.seconds > film.keys.back().seconds))
            refuse_film(fmt::format("keys[{}].at {}: must be later than the key before", i, made.seconds));
        std::vector<std::string> unknown;
        try {
            made.scene = parse_scene(key["scene"].dump(), folder, data_folder, unknown);
        } catch (const Error& error) {
            refuse_film(fmt::format("keys[{}].scene: {}", i, error.what()));
        }
        if (i > 0 && made.scene.volume != film.keys.front().scene.volume)
            refuse_film(fmt::format("keys[{}].scene: must be of the first one's volume", i));
        for (const std::string& name : unknown) unknown_keys.push_back(fmt::format("keys[{}].scene.{}", i, name));
        film.keys.push_back(std::move(made));
    }
}

}  // namespace

int frame_count(const Film& film) {
    const double seconds = film.keys.back().seconds - film.keys.front().seconds;
    return int(std::min(std::floor(seconds * film.fps + 1e-6), double(max_film_frames))) + 1;
}

Scene frame_of(const Film& film, const Geometry& geometry, const std::array<int, 3>& dimensions, int frame) {
    std::vector<double> times;
    std::vector<const Scene*> scenes;
    for (const Keyframe& key : film.keys) times.push_back(key.seconds), scenes.push_back(&key.scene);
    const double seconds = std::min(times.front() + frame / film.fps, times.back());
    std::size_t i = 0;
    while (i + 1 < times.size() && times[i + 1] <= seconds + 1e-9) ++i;
    Scene scene = *scenes[i];
    if (i + 1 < times.size())
        scene =
            mixed_settings(*scenes[i], *scenes[i + 1], std::max(0.0, (seconds - times[i]) / (times[i + 1] - times[i])));
    scene.camera = camera_on_path(times, scenes, geometry, dimensions, seconds);
    scene.width = film.width, scene.height = film.height;
    return scene;
}

Film parse_film(const std::string& json, const std::filesystem::path& folder, const std::filesystem::path& data_folder,
                std::vector<std::string>& unknown_keys) {
    const ReadJson root = parse_film_json(json);
    if (!root.is_object() || !root.contains("film") || root["film"] != 1)
        refuse_film("must be a JSON object with \"film\": 1");
    Film film;
    film.fps = film_number(root, "fps", film.fps, 0.1, 1000);
    if (root.contains("size")) {
        const ReadJson& size = root["size"];
        const auto side = [&](std::size_t k) {
            const bool is_size = size.is_array() && size.size() == 2 && size[k].is_number_integer();
            const auto pixels = is_size ? size[k].get<std::int64_t>() : 0;
            if (pixels < 1 || pixels > 16384) refuse_film("size: must be [width, height] of 1 to 16384 pixels");
            return int(pixels);
        };
        film.width = side(0), film.height = side(1);
    }
    read_keys(root, folder, data_folder, unknown_keys, film);
    if ((film.keys.back().seconds - film.keys.front().seconds) * film.fps > max_film_frames)
        refuse_film(fmt::format("has more than {} frames", max_film_frames));
    return film;
}

Film read_film(const std::filesystem::path& file, const std::filesystem::path& data_folder,
               std::vector<std::string>& unknown_keys) {
    try {
        return parse_film(file_text(file, max_film_bytes), file.parent_path(), data_folder, unknown_keys);
    } catch (const Error& error) {
        const std::string what = error.what();
        throw Error(error.code(),
                    what.starts_with("film: ") ? fmt::format("{}: {}", file.string(), what.substr(6)) : what);
    }
}

std::string to_json(const Film& film) {
    Json root{{"film", 1}, {"fps", film.fps}, {"size", {film.width, film.height}}, {"keys", Json::array()}};
    for (const Keyframe& key : film.keys)
        root["keys"].push_back({{"at", key.seconds}, {"scene", Json::parse(to_json(key.scene))}});
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace chiaro
