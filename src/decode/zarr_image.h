// What a Zarr store shows: an image of several levels as OME-NGFF describes it, or one array.
#pragma once
#include "decode/zarr_array.h"

namespace chiaro::decode {

/// Where the axes of its arrays lead, and what is known of it but voxels.
struct ZarrImage {
    std::vector<ZarrArray> levels;  ///< finest first
    std::vector<Geometry> geometries;
    /// The axes of the arrays that are x, y and z (-1: there is none), time and channel.
    std::array<int, 3> space{-1, -1, -1};
    int time = -1, channel = -1;
    int first_channel = 0;  ///< that is shown
    Volume header;
};

/// Orientation, slope, intercept and modality, which `chiaro convert` states of a group. Throws where one is none.
void take_own_attributes(const nlohmann::json& attributes, ZarrImage& image);

/// `part`: the path of an image or array in the store, and behind '@' a channel by its name or number; may be empty.
/// Throws Error{input} where there is none, or several arrays, which it names.
ZarrImage open_zarr_image(const ZarrStore& store, const std::string& part, const Output& output);

}  // namespace chiaro::decode
