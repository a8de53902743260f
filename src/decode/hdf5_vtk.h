// VTK's image data in HDF5 (.vtkhdf): the group VTKHDF of a file.
#pragma once
#include "decode/hdf5_file.h"

#include <chiaro/volume.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace chiaro::decode {

/// The array that is shown, by its path, and how many values it must have along x, y and z.
struct VtkHdfImage {
    std::string dataset;
    std::array<std::int64_t, 3> values;
};

/// None: the file has no such group. Sets the volume's place, and names what else is there in a note. Throws
/// Error{input} for VTK data of other kinds.
std::optional<VtkHdfImage> vtkhdf_image(hid_t file, Volume& volume);

}  // namespace chiaro::decode
