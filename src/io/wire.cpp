#include "io/wire.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace chiaro::wire {
namespace {

using nlohmann::json;

json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vec3_from(const json& j) { return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()}; }

json to_json(const std::vector<ComponentInfo>& infos) {
    json list = json::array();
    for (const auto& [name, rgb] : infos) list.push_back({{"name", name}, {"rgb", rgb ? json(*rgb) : json()}});
    return list;
}

std::vector<ComponentInfo> infos_from(const json& list, std::size_t components) {
    if (!list.empty() && list.size() != components) throw std::out_of_range("component_infos");
    std::vector<ComponentInfo> infos;
    for (const json& one : list) {
        ComponentInfo& info = infos.emplace_back(ComponentInfo{one.at("name").get<std::string>(), {}});
        if (const json& rgb = one.at("rgb"); !rgb.is_null()) {
            info.rgb = rgb.get<std::array<double, 3>>();
            for (double c : *info.rgb)
                if (!(c >= 0 && c <= 1)) throw std::out_of_range("rgb");
        }
    }
    return infos;
}

/// get<int> takes any number, and has no answer to one that is none of int's.
int int_from(const json& j) {
    const auto value = j.get<double>();
    if (!(value >= std::numeric_limits<int>::min() && value <= std::numeric_limits<int>::max()))
        throw std::out_of_range("a whole number");
    return int(value);
}

template <class Enum>
Enum enum_from(const json& j, Enum last) {
    const int value = int_from(j);
    if (value < 0 || value > int(last)) throw std::out_of_range("enumerator");
    return Enum(value);
}

std::array<int, 3> ints_from(const json& j) { return {int_from(j.at(0)), int_from(j.at(1)), int_from(j.at(2))}; }

void add_geometry(json& to, const Geometry& geometry) {
    const auto& direction = geometry.direction;
    to["spacing_mm"] = to_json(geometry.spacing_mm);
    to["origin_mm"] = to_json(geometry.origin_mm);
    to["direction"] = {to_json(direction[0]), to_json(direction[1]), to_json(direction[2])};
    to["world"] = int(geometry.world);
}

Geometry geometry_from(const json& j) {
    Geometry geometry;
    geometry.spacing_mm = vec3_from(j.at("spacing_mm"));
    geometry.origin_mm = vec3_from(j.at("origin_mm"));
    for (int axis = 0; axis < 3; ++axis) geometry.direction[axis] = vec3_from(j.at("direction").at(axis));
    geometry.world = enum_from(j.at("world"), World::ras);
    return geometry;
}

Moments moments_from(const json& j) {
    Moments moments{.count = int_from(j.at("count")),
                    .shown = int_from(j.at("shown")),
                    .times = j.at("times").get<std::vector<double>>(),
                    .unit = j.at("unit").get<std::string>()};
    const bool is_one_of_them = moments.shown >= 0 && moments.shown < moments.count;
    if (!is_one_of_them || !(moments.times.empty() || moments.times.size() == std::size_t(moments.count)))
        throw std::out_of_range("moments");
    return moments;
}

}  // namespace

json header_to_json(const Volume& volume) {
    json header{{"dimensions", volume.dimensions},
                {"type", int(volume.type)},
                {"components", volume.components},
                {"has_own_colors", volume.has_own_colors},
                {"component_infos", to_json(volume.component_infos)},
                {"slope", volume.slope},
                {"intercept", volume.intercept},
                {"moments",
                 {{"count", volume.moments.count},
                  {"shown", volume.moments.shown},
                  {"times", volume.moments.times},
                  {"unit", volume.moments.unit}}},
                {"format", volume.format},
                {"modality", volume.modality},
                {"notes", volume.notes},
                {"key_values", volume.key_values}};
    add_geometry(header, volume.geometry);
    return header;
}

Volume header_from_json(const json& j) {
    Volume volume;
    volume.dimensions = ints_from(j.at("dimensions"));
    volume.type = enum_from(j.at("type"), VoxelType::f64);
    volume.components = int_from(j.at("components"));
    volume.has_own_colors = j.at("has_own_colors").get<bool>() && (volume.components == 3 || volume.components == 4);
    volume.component_infos = infos_from(j.at("component_infos"), std::size_t(std::max(volume.components, 0)));
    volume.slope = j.at("slope").get<double>();
    volume.intercept = j.at("intercept").get<double>();
    volume.geometry = geometry_from(j);
    volume.moments = moments_from(j.at("moments"));
    volume.format = j.at("format").get<std::string>();
    volume.modality = j.at("modality").get<std::string>();
    volume.notes = j.at("notes").get<std::vector<std::string>>();
    volume.key_values = j.at("key_values").get<std::map<std::string, std::string>>();
    return volume;
}

nlohmann::json to_json(const VoxelsInFile& place) {
    const std::string path = place.path.string();  // bytes: it need not be UTF-8, which JSON's texts are
    return {{"path", std::vector<std::uint8_t>(path.begin(), path.end())},
            {"offset", place.offset},
            {"big_endian", place.big_endian}};
}

VoxelsInFile place_from_json(const nlohmann::json& json) {
    const auto path = json.at("path").get<std::vector<std::uint8_t>>();
    return {std::string(path.begin(), path.end()), json.at("offset").get<std::uint64_t>(),
            json.at("big_endian").get<bool>()};
}

nlohmann::json to_json(const std::vector<ChunkedLevel>& levels) {
    json list = json::array();
    for (const ChunkedLevel& level : levels) {
        json one{{"dimensions", level.dimensions}, {"chunk", level.chunk}};
        add_geometry(one, level.geometry);
        list.push_back(std::move(one));
    }
    return list;
}

std::vector<ChunkedLevel> levels_from_json(const nlohmann::json& json) {
    std::vector<ChunkedLevel> levels;
    for (const auto& j : json)
        levels.push_back({ints_from(j.at("dimensions")), ints_from(j.at("chunk")), geometry_from(j)});
    return levels;
}

}  // namespace chiaro::wire
