#include "io/volume_json.h"

namespace chiaro {
namespace {

OrderedJson json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Rows of the matrix whose columns are the index axes in the world.
OrderedJson json_of(const std::array<Vec3, 3>& direction) {
    OrderedJson rows = OrderedJson::array();
    for (int row = 0; row < 3; ++row) rows.push_back({direction[0][row], direction[1][row], direction[2][row]});
    return rows;
}

}  // namespace

std::string_view name_of(World world) { return world == World::lps ? "LPS" : world == World::ras ? "RAS" : "unknown"; }

OrderedJson json_of(const Volume& volume) {
    const Geometry& g = volume.geometry;
    OrderedJson json;
    json["file"] = volume.source;
    json["format"] = volume.format;
    json["dimensions"] = volume.dimensions;
    json["type"] = name_of(volume.type);
    json["components"] = volume.components;
    if (volume.components > 2) json["own_colors"] = volume.has_own_colors;
    json["spacing_mm"] = json_of(g.spacing_mm);
    json["origin_mm"] = json_of(g.origin_mm);
    json["direction"] = json_of(g.direction);
    json["world"] = name_of(g.world);
    if (const Moments& moments = volume.moments; moments.count > 1)
        json["moments"] = {
            {"count", moments.count}, {"shown", moments.shown}, {"times", moments.times}, {"unit", moments.unit}};
    return json;
}

OrderedJson info_of(const Volume& volume, const Statistics& s, const Guess& guess) {
    OrderedJson json = json_of(volume);
    json["range"] = {s.min, s.max};
    json["percentiles"] = {{"1", s.p1}, {"50", s.p50}, {"99", s.p99}, {"99.9", s.p999}};
    json["noise"] = s.noise;
    json["histogram"] = {{"min", s.min}, {"max", s.max}, {"counts", s.histogram}};
    json["nonfinite"] = s.nonfinite;
    json["modality_guess"] = guess.modality;
    json["preset_guess"] = guess.preset;
    json["notes"] = volume.notes;
    return json;
}

}  // namespace chiaro
