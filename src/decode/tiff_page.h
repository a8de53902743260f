// One page of a TIFF file: what it is, and its values.
#pragma once
#include <chiaro/volume.h>
#include <tiffio.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace chiaro::decode {

struct TiffCloser {
    void operator()(TIFF* file) const { TIFFClose(file); }
};
using TiffFile = std::unique_ptr<TIFF, TiffCloser>;

/// Throws Error{input} naming the file.
TiffFile open_tiff(const std::filesystem::path& path);

/// Goes on to the next page. Throws Error{input} where it is damaged or missing.
void next_page(TIFF* file);

enum class TiffColor { grey, grey_from_white, palette, rgb };

struct TiffPage {
    int columns = 0, rows = 0;
    VoxelType type = VoxelType::u8;
    TiffColor color = TiffColor::grey;
    int samples = 1;  ///< stored for each pixel
    int values = 1;   ///< kept of them: the first, red, green and blue with their alpha, or all
    double x_resolution = 0, y_resolution = 0;  ///< pixels in a unit; 0: not stated
    double unit_mm = 0;                         ///< 0: not stated
    bool are_sizes_guessed = false;             ///< of its strips, which are stated wrong or not at all
    std::string description;

    /// Of one value a pixel.
    std::size_t bytes() const { return std::size_t(columns) * std::size_t(rows) * size_of(type); }
    bool same_kind(const TiffPage& other) const {
        return columns == other.columns && rows == other.rows && type == other.type && color == other.color &&
               values == other.values;
    }
};

/// The current page of the file. Throws Error{input} for pixels that are not read: bits that are no whole bytes,
/// colours other than grey, palette and RGB; and where the file is too short for its strips or tiles.
TiffPage scan_page(TIFF* file, std::uint64_t file_size);

/// Some columns and rows of a page.
struct PixelBox {
    int column = 0, row = 0, columns = 0, rows = 0;
};

/// Which values of a pixel are kept, and where they go. Distances are counted in values.
struct PixelTarget {
    std::byte* to = nullptr;
    int first = 0, count = 1;         ///< of the pixel's
    std::size_t pixel = 1, line = 0;  ///< from one to the next in `to`
};

/// The strips or tiles of the current page: columns and rows of one. Throws Error{input} where they have no size.
PixelBox strip_of(TIFF* file, const TiffPage& page);

/// Bytes of one as decoded, all samples of its pixels included.
std::uint64_t strip_bytes(TIFF* file);

/// Puts those of the pixels of `stored` that lie in the box into their places. From `from` on they lie row by row, of
/// each pixel `samples` values, the first of which is that of number `sample`. Values that grow from white are turned
/// around.
void put_pixels(const TiffPage& page, const PixelBox& stored, const std::byte* from, int samples, int sample,
                const PixelBox& box, const PixelTarget& target);

/// Decodes a box of the current page, and no strip or tile outside of it. Throws Error{input} for damaged or missing
/// data.
void read_pixels(TIFF* file, const TiffPage& page, const PixelBox& box, const PixelTarget& target);

}  // namespace chiaro::decode
