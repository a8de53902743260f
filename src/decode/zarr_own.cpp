// What `chiaro convert` writes beside what OME-Zarr has a place for.
#include "decode/zarr_image.h"

namespace chiaro::decode {

void take_own_attributes(const nlohmann::json& attributes, ZarrImage& image) {
    if (!attributes.contains("chiaro")) return;
    const nlohmann::json& own = attributes.at("chiaro");
    std::array<Vec3, 3> direction;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 3; ++i) direction[axis][i] = own.at("direction").at(axis).at(std::size_t(i)).get<double>();
    const int world = own.at("world").get<int>();
    if (world < 0 || world > int(World::ras)) refuse("states a world that is none");
    const Vec3 origin = image.geometries.front().origin_mm;
    for (Geometry& geometry : image.geometries) {
        const Vec3 shift = geometry.origin_mm - origin;
        geometry.origin_mm = origin + shift.x * direction[0] + shift.y * direction[1] + shift.z * direction[2];
        geometry.direction = direction;
        geometry.world = World(world);
    }
    image.header.slope = own.at("slope").get<double>();
    image.header.intercept = own.at("intercept").get<double>();
    image.header.modality = own.at("modality").get<std::string>();
}

}  // namespace chiaro::decode
