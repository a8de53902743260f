// Which dataset of an HDF5 file is the volume, and what its axes are.
//
// The last axis is x, as everywhere where volumes are kept in HDF5. Spacing comes from the attribute `element_size_um`
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
    std::optional<std::size_t> channels;  ///< the axis of channels: before those in space, or behind them
    bool is_interleaved() const { return channels && *channels > axes.back(); }
};

/// An open volume, and all that is known of it but its voxels.
struct Hdf5Volume {
    Hdf5Id file, dataset;
    Hdf5Shape shape;
    Volume header;
};

/// Throws Error{input} where there is none, or more than one and `part` names none of them.
Hdf5Volume open_hdf5_volume(const std::filesystem::path& path, const std::string& part);

/// How the library hands over values of this type.
hid_t hdf5_memory_type(VoxelType type);

}  // namespace chiaro::decode
