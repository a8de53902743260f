// Which dataset of an HDF5 file is the volume, and what its axes are.
//
// The last axis is x, as everywhere where volumes are kept in HDF5, unless `axistags` (vigra, ilastik) names them.
// Spacing comes from the attribute `element_size_um`
// (ilastik, Fiji; micrometres) or `spacing` (millimetres), both in the order of the dataset's axes.
#pragma once
#include <optional>

#include "decode/hdf5_file.h"
#include "decode/output.h"

namespace chiaro::decode {

/// A dataset that can be a volume.
struct Hdf5Shape {
    VoxelType type = VoxelType::u8;
    std::vector<hsize_t> sizes;           ///< of all axes, slowest first
    std::vector<std::size_t> axes;        ///< those in space: up to three, without others of one element
    std::optional<std::size_t> channels;  ///< the axis of channels
    std::optional<std::size_t> time;      ///< the axis of moments
    std::string letters;                  ///< x, y, z, c or t for each axis, as the file names them; empty: it does not
    hsize_t moment = 0;                   ///< that is shown
    bool is_interleaved() const { return channels && *channels > axes.back(); }
};

/// An open volume, and all that is known of it but its voxels.
struct Hdf5Volume {
    Hdf5Id file, dataset;
    Hdf5Shape shape;
    Volume header;
};

/// Throws Error{input} where there is none, or more than one and `part` names none of them; or no moment that the
/// output asks for.
Hdf5Volume open_hdf5_volume(const std::filesystem::path& path, const std::string& part, const Output& output);

/// How the library hands over values of this type.
hid_t hdf5_memory_type(VoxelType type);

}  // namespace chiaro::decode
