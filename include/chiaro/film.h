// Scenes in a row: keyframes, and the scene of each frame between them.
#pragma once
#include <chiaro/export.h>
#include <chiaro/scene.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace chiaro {

struct Keyframe {
    double seconds = 0;
    Scene scene;
};

struct Film {
    double fps = 25;  ///< frames a second
    int width = 1280, height = 720;
    std::vector<Keyframe> keys;  ///< at least one, of one volume; seconds rise
};
inline constexpr std::size_t max_keyframes = 1000;
inline constexpr int max_film_frames = 100000;

/// From the first key to the last, both included.
CHIARO_EXPORT int frame_count(const Film& film);

/// The scene of a frame, 0 to frame_count - 1, of the film's size. Between two keys numbers of settings change evenly;
/// transfer functions of as many points move point by point, others fade into each other. What is no number, and lists
/// of different lengths, hold until the next key. The camera goes through its keys on a smooth path (cubic Hermite,
/// with Catmull and Rom's tangents): as an orbit, azimuth and roll the shorter way; where a key has eye and target, the
/// target moves, and the eye turns about it. Functions are mixed where both keys have points. Throws as make_camera.
CHIARO_EXPORT Scene frame_of(const Film& film, const Geometry& geometry, const std::array<int, 3>& dimensions,
                             int frame);

/// {"film": 1, "fps": 25, "size": [w, h], "keys": [{"at": seconds, "scene": {...}}, ...]}; file names as in scenes.
/// Throws Error{input} that names the key and what is wrong with it.
CHIARO_EXPORT Film parse_film(const std::string& json, const std::filesystem::path& folder,
                              const std::filesystem::path& data_folder, std::vector<std::string>& unknown_keys);
CHIARO_EXPORT Film read_film(const std::filesystem::path& file, const std::filesystem::path& data_folder,
                             std::vector<std::string>& unknown_keys);
CHIARO_EXPORT std::string to_json(const Film& film);

}  // namespace chiaro
