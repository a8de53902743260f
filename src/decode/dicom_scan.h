// One DICOM file, before its pixels are decoded.
#pragma once
#include <chiaro/volume.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::decode {

/// One picture of a file: a slice. Positions and directions in LPS millimetres.
struct DicomSlice {
    std::filesystem::path path;
    int frame = 0, frames = 1;  ///< which of how many pictures of its file
    int slot = 0;               ///< which slice of the volume it is; set when a series is arranged
    std::string series, description, modality;
    int columns = 0, rows = 0, instance = 0;
    VoxelType type = VoxelType::u16;
    bool has_place = false;  ///< position and orientation are stated
    Vec3 position, along_row{1, 0, 0}, along_column{0, 1, 0};
    double column_spacing = 1, row_spacing = 1;  ///< mm between neighbours in a row (x) and in a column (y)
    double thickness = 1;
    double slope = 1, intercept = 0;
    std::optional<double> trigger_ms;  ///< when it was taken after the heart's beat
    std::optional<double> temporal;    ///< its number among those that were taken at its place

    std::size_t bytes() const { return std::size_t(columns) * std::size_t(rows) * size_of(type); }
};

/// What GDCM takes beside the bytes of a file and of its picture.
constexpr std::uint64_t working_memory = 16 << 20;

/// The slices of a file: one, or one per frame. None for what is no DICOM image.
/// Throws Error{input} for images of a kind that is not read: colour, or bits that are no whole bytes.
std::vector<DicomSlice> scan_dicom_file(const std::filesystem::path& path);

}  // namespace chiaro::decode
