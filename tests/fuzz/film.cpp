#include "fuzz.h"

#include <chiaro/film.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        std::vector<std::string> unknown;
        const auto film = chiaro::parse_film(fuzz::text(data, size), "folder", "", unknown);
        const auto json = chiaro::to_json(film);
        if (chiaro::to_json(chiaro::parse_film(json, "", "", unknown)) != json) std::abort();
        const int count = chiaro::frame_count(film);
        chiaro::Geometry geometry;
        geometry.world = chiaro::World::lps;
        for (const int frame : {0, count / 3, count / 2, count - 1})
            chiaro::to_json(chiaro::frame_of(film, geometry, {8, 9, 10}, frame));
    });
}
