// Films: keyframes, and the scene of each frame between them.
#include <chiaro/film.h>

#include "binding.h"

namespace chiaro::python {
namespace {

std::pair<Film, std::vector<std::string>> read(const std::string& file, const std::string& data) {
    std::vector<std::string> unknown;
    Film film = read_film(file, data, unknown);
    return {std::move(film), std::move(unknown)};
}

Film film_of(const std::vector<std::pair<double, Scene>>& keys, double fps, int width, int height) {
    Film film{.fps = fps, .width = width, .height = height, .keys = {}};
    for (const auto& [seconds, scene] : keys) film.keys.push_back({seconds, scene});
    return film;
}

/// What the camera fits is found once, for all keys that do not say it.
Film fitted(Film film, const Scene& by) {
    for (Keyframe& key : film.keys)
        if (key.scene.camera.fit == Fit::visible && !key.scene.camera.fit_centre)
            key.scene.camera.fit_centre = by.camera.fit_centre,
            key.scene.camera.fit_radius_mm = by.camera.fit_radius_mm;
    return film;
}

}  // namespace

void add_film(py::module_& module) {
    py::class_<Film>(module, "Film")
        .def_property_readonly("frames", [](const Film& film) { return frame_count(film); })
        .def_property_readonly("first", [](const Film& film) { return film.keys.front().scene; })
        .def("fitted", fitted)
        .def("scene", [](const Film& film, const VolumeHandle& of, int frame) {
            return frame_of(film, of.volume->geometry, of.volume->dimensions, frame);
        });
    module.def("read_film", read);
    module.def("film_of", film_of);
}

}  // namespace chiaro::python
