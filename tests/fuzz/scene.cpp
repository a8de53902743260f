#include "fuzz.h"

#include <chiaro/scene.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        std::vector<std::string> unknown;
        const auto scene = chiaro::parse_scene(fuzz::text(data, size), "folder", "", unknown);
        const auto json = chiaro::to_json(scene);
        if (chiaro::to_json(chiaro::parse_scene(json, "", "", unknown)) != json) std::abort();
    });
}
