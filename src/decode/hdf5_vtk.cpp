#include "decode/hdf5_vtk.h"

#include "decode/output.h"
#include "decode/vtk_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace chiaro::decode {
namespace {

/// Exactly `count` numbers of an attribute.
std::vector<double> number_attribute(hid_t object, const char* name, std::size_t count) {
    const auto lacks = [&] { refuse(fmt::format("has a VTKHDF group whose {} is not {} numbers", name, count)); };
    if (H5Aexists(object, name) <= 0) lacks();
    const Hdf5Id stored(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Id type(H5Aget_type(stored), H5Tclose), space(H5Aget_space(stored), H5Sclose);
    const auto kind = H5Tget_class(type);
    if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_npoints(space) != hssize_t(count)) lacks();
    std::vector<double> values(count);
    if (H5Aread(stored, H5T_NATIVE_DOUBLE, values.data()) < 0) lacks();
    return values;
}

/// Points along each axis; sets the geometry.
std::array<std::int64_t, 3> set_geometry(hid_t group, Volume& volume) {
    VtkPlace place{.extent = number_attribute(group, "WholeExtent", 6),
                   .origin = number_attribute(group, "Origin", 3),
                   .spacing = number_attribute(group, "Spacing", 3),
                   .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    if (H5Aexists(group, "Direction") > 0) place.direction = number_attribute(group, "Direction", 9);
    return set_place(place, volume);
}

}  // namespace

std::optional<VtkHdfImage> vtkhdf_image(hid_t file, Volume& volume) {
    H5L_info_t link{};
    if (H5Lexists(file, "/VTKHDF", H5P_DEFAULT) <= 0 || H5Lget_info(file, "/VTKHDF", &link, H5P_DEFAULT) < 0 ||
        link.type != H5L_TYPE_HARD)
        return {};
    const Hdf5Id group(H5Oopen(file, "/VTKHDF", H5P_DEFAULT), H5Oclose);
    if (!group.is_valid() || H5Iget_type(group) != H5I_GROUP) return {};
    if (const std::string type = text_attribute(group, "Type"); type != "ImageData")
        refuse("holds VTK data of type '" + type + "', not ImageData");
    const auto points = set_geometry(group, volume);
    std::vector<VtkArray> arrays;
    std::vector<std::string> paths;
    const auto all = datasets_in(file);
    for (const std::string of : {"PointData", "CellData"}) {
        const std::string folder = "/VTKHDF/" + of + "/";
        std::string active;
        if (H5Lexists(group, of.c_str(), H5P_DEFAULT) > 0) {
            const Hdf5Id data(H5Oopen(group, of.c_str(), H5P_DEFAULT), H5Oclose);
            if (data.is_valid()) active = text_attribute(data, "Scalars");
        }
        for (const std::string& path : all) {
            const std::string name = path.starts_with(folder) ? path.substr(folder.size()) : "";
            if (name.empty() || name.find('/') != name.npos) continue;
            arrays.push_back({.name = name, .of_cells = of == "CellData", .active = name == active});
            paths.push_back(path);
        }
    }
    const std::size_t chosen = choose_array(arrays, volume);
    set_shape(arrays[chosen], points, volume);
    const auto& n = volume.dimensions;
    return VtkHdfImage{paths[chosen], {n[0], n[1], n[2]}};
}

}  // namespace chiaro::decode
