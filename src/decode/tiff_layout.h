// What the description of a TIFF file says beyond its pages: ImageJ's lines, or OME's XML.
#pragma once
#include <chiaro/volume.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::decode {

/// A page that lies in one of several files.
struct TiffPlane {
    std::string file;
    std::size_t page, place;  ///< in the file; in the order of all
};

/// The order of the pages, and their place. Page of channel c, slice z, time t:
/// c * channel_step + z * slice_step + t * time_step.
struct TiffLayout {
    bool stated = false;
    std::int64_t channels = 1, slices = 1, times = 1;  ///< as many pages as their product
    std::int64_t channel_step = 1, slice_step = 1, time_step = 1;
    double seconds = 0;             ///< between moments; 0: not told
    std::optional<double> unit_mm;  ///< ImageJ: of the resolution tags and of z_spacing
    std::optional<double> x_spacing_mm, y_spacing_mm, z_spacing_mm;
    double slope = 1, intercept = 0;           ///< of a linear calibration
    std::vector<ComponentInfo> channel_infos;  ///< as many as are told of
    std::vector<TiffPlane> planes;             ///< of OME's in several files; empty: all lie in this one
    std::string metadata_file;                 ///< that says all this in the place of this one
    std::int64_t images() const { return channels * slices * times; }
};

/// Nothing stated for any other text. `samples`: of a pixel, which OME counts among the channels. Throws Error{input}
/// for numbers that make no sense.
TiffLayout layout_from(const std::string& description, std::int64_t pages, int samples);
/// Colours of channels as ImageJ keeps them, in the metadata (tag 50839) that `counts` (tag 50838) divides: the last
/// entry of each look-up table. Empty for anything else.
std::vector<ComponentInfo> imagej_colors(const std::vector<std::uint32_t>& counts, const std::string& metadata);

}  // namespace chiaro::decode
