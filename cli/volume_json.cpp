#include "volume_json.h"

namespace chiaro::cli {
namespace {

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Rows of the matrix whose columns are the index axes in the world.
Json json_of(const std::array<Vec3, 3>& direction) {
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) rows.push_back({direction[0][row], direction[1][row], direction[2][row]});
    return rows;
}

}  // namespace

std::string_view name_of(World world) { return world == World::lps ? "LPS" : world == World::ras ? "RAS" : "unknown"; }

Json json_of(const Volume& volume) {
    const Geometry& g = volume.geometry;
    Json json;
    json["file"] = volume.source;
    json["format"] = volume.format;
    json["dimensions"] = volume.dimensions;
    json["type"] = chiaro::name_of(volume.type);
    json["components"] = volume.components;
    json["spacing_mm"] = json_of(g.spacing_mm);
    json["origin_mm"] = json_of(g.origin_mm);
    json["direction"] = json_of(g.direction);
    json["world"] = name_of(g.world);
    return json;
}

}  // namespace chiaro::cli
