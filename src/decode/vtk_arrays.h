// What VTK's two kinds of files share: which of several arrays is the volume, and its place.
#pragma once
#include <chiaro/volume.h>

#include <cstdint>
#include <string>
#include <vector>

namespace chiaro::decode {

struct VtkArray {
    std::string name;
    bool of_cells = false;  ///< else of points
    bool active = false;    ///< named as the scalars to show
    VoxelType type = VoxelType::u8;
    std::int64_t components = 1;
    bool are_colors = false;  ///< as the file says
};

/// The index of the array to read: the active scalars of the points, else the first of the points, else the same of
/// the cells. The others are named in a note. Throws Error{input} where there is none.
std::size_t choose_array(const std::vector<VtkArray>& arrays, Volume& volume);

/// Where an image stands, by its points: position = origin + direction (spacing * index), with the indices of the
/// extent, which need not begin at 0. Nothing is said about anatomy.
struct VtkPlace {
    std::vector<double> extent;  ///< first and last along each axis, whole numbers
    std::vector<double> origin, spacing;
    std::vector<double> direction;  ///< rows of a matrix
};
/// Sets the geometry and returns the points along each axis. Throws Error{input} for other than 6, 3, 3 and 9 numbers,
/// an extent that is none and places that `check_geometry` refuses.
std::array<std::int64_t, 3> set_place(const VtkPlace& place, Volume& volume);

/// Sets the shape from the number of points along each axis: values of cells are voxels between the points.
/// Returns the bytes of all voxels; throws Error{input} as checked_bytes does.
std::uint64_t set_shape(const VtkArray& array, const std::array<std::int64_t, 3>& points, Volume& volume);

}  // namespace chiaro::decode
