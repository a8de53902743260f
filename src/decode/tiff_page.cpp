#include "decode/tiff_page.h"

#include "decode/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <limits>
#include <vector>

namespace chiaro::decode {
namespace {

std::string last_complaint;
bool are_sizes_guessed = false;  ///< of the strips of the page read last

void complain(const char*, const char* format, std::va_list arguments) {
    char text[300];
    std::vsnprintf(text, sizeof text, format, arguments);
    if (last_complaint.empty()) last_complaint = text;
}

/// A JPEG stream that ends early is filled with grey by its library, which only warns; so does libtiff of tags that lie
/// behind the file's end.
void hear_warning(const char* module, const char* format, std::va_list arguments) {
    char text[300];
    std::vsnprintf(text, sizeof text, format, arguments);
    are_sizes_guessed = are_sizes_guessed || std::strstr(text, "calculating from imagelength");
    if (std::strstr(text, "remature end") || std::strstr(text, "IO error") ||
        std::strstr(module ? module : "", "JPEGLib"))
        last_complaint = text;
}

std::string because() { return last_complaint.empty() ? "" : " (" + last_complaint + ")"; }

template <class T>
T tag(TIFF* file, std::uint32_t name, T fallback) {
    T value = fallback;
    return TIFFGetFieldDefaulted(file, name, &value) ? value : fallback;
}

VoxelType tiff_type(int bits, int format) {
    const bool is_signed = format == SAMPLEFORMAT_INT, is_float = format == SAMPLEFORMAT_IEEEFP;
    if (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID || is_signed) {
        if (bits == 8) return is_signed ? VoxelType::i8 : VoxelType::u8;
        if (bits == 16) return is_signed ? VoxelType::i16 : VoxelType::u16;
        if (bits == 32) return is_signed ? VoxelType::i32 : VoxelType::u32;
        if (bits == 64) return is_signed ? VoxelType::i64 : VoxelType::u64;
    }
    if (is_float && bits == 32) return VoxelType::f32;
    if (is_float && bits == 64) return VoxelType::f64;
    refuse(fmt::format("has pixels of {} bits{}; integers of 8 to 64 bits and floats of 32 and 64 are read", bits,
                       is_float ? " as floats" : ""));
}

TiffColor color_from(TIFF* file, int samples) {
    const int photometric = tag<std::uint16_t>(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    const int compression = tag<std::uint16_t>(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    switch (photometric) {
        case PHOTOMETRIC_MINISBLACK:
            return TiffColor::grey;
        case PHOTOMETRIC_MINISWHITE:
            return TiffColor::grey_from_white;
        case PHOTOMETRIC_PALETTE:
            return TiffColor::palette;
        case PHOTOMETRIC_YCBCR:
            if (compression != COMPRESSION_JPEG) break;
            TIFFSetField(file, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);  // libjpeg turns it into RGB
            [[fallthrough]];
        case PHOTOMETRIC_RGB:
            if (samples < 3) refuse(fmt::format("states RGB with {} values a pixel", samples));
            return TiffColor::rgb;
        default:
            break;
    }
    refuse(
        fmt::format("has the colours of photometric interpretation {}; grey, palette and RGB are read", photometric));
}

/// How many times larger than its stored bytes a strip can be.
std::uint64_t largest_ratio(TIFF* file) {
    switch (tag<std::uint16_t>(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE)) {
        case COMPRESSION_NONE:
            return 1;
        case COMPRESSION_PACKBITS:
            return 64;
        case COMPRESSION_LZW:
            return 4096;
        case COMPRESSION_DEFLATE:
        case COMPRESSION_ADOBE_DEFLATE:
            return 1033;
        default:
            return 1 << 17;
    }
}

std::uint32_t chunks_of(TIFF* file) { return TIFFIsTiled(file) ? TIFFNumberOfTiles(file) : TIFFNumberOfStrips(file); }

void check_capacity(TIFF* file, const TiffPage& page, std::uint64_t file_size) {
    std::uint64_t stored = 0;
    for (std::uint32_t i = 0; i < chunks_of(file); ++i) {
        const std::uint64_t at = TIFFGetStrileOffset(file, i), bytes = TIFFGetStrileByteCount(file, i);
        if (at > file_size || bytes > file_size - at)
            refuse(fmt::format("is truncated: its data reach to byte {} of {}", at + bytes, file_size));
        stored += bytes;
    }
    const std::uint64_t needed = page.bytes() * std::uint64_t(page.samples);
    const auto most = std::min(stored, file_size) * largest_ratio(file);
    if (needed > most)
        refuse(fmt::format("states {} bytes of pixels, but can hold at most {}: truncated, or a wrong header", needed,
                           most));
}

void take_resolution(TIFF* file, TiffPage& page) {
    const double x = double(tag<float>(file, TIFFTAG_XRESOLUTION, 0)),
                 y = double(tag<float>(file, TIFFTAG_YRESOLUTION, 0));
    if (!(x > 0 && y > 0 && std::isfinite(x) && std::isfinite(y))) return;
    page.x_resolution = x;
    page.y_resolution = y;
    const int unit = tag<std::uint16_t>(file, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
    page.unit_mm = unit == RESUNIT_INCH ? 25.4 : unit == RESUNIT_CENTIMETER ? 10 : 0;
}

template <class T>
T value_of(T stored, TiffColor color) {
    if constexpr (std::is_unsigned_v<T>)
        if (color == TiffColor::grey_from_white) return T(std::numeric_limits<T>::max() - stored);
    return stored;
}

/// Red, green, blue and their alpha; of grey all but those that say how opaque a pixel is; of a palette the index.
int kept_values(TIFF* file, const TiffPage& page) {
    const int own = page.color == TiffColor::rgb ? 3 : 1;
    std::uint16_t count = 0, *kinds = nullptr;
    if (!TIFFGetField(file, TIFFTAG_EXTRASAMPLES, &count, &kinds)) count = 0;
    const auto is_alpha = [&](int i) {
        return i < count && (kinds[i] == EXTRASAMPLE_ASSOCALPHA || kinds[i] == EXTRASAMPLE_UNASSALPHA);
    };
    if (page.color == TiffColor::palette) return 1;
    if (page.color == TiffColor::rgb) return page.samples > 3 && is_alpha(0) ? 4 : 3;
    int values = own;
    constexpr int max_shown = 8;
    while (values < std::min(page.samples, max_shown) && !is_alpha(values - own)) ++values;
    return values;
}

}  // namespace

TiffFile open_tiff(const std::filesystem::path& path) {
    TIFFSetErrorHandler(complain);
    TIFFSetWarningHandler(hear_warning);
    last_complaint.clear();
    are_sizes_guessed = false;
    TiffFile file(TIFFOpen(path.c_str(), "rm"));  // not mapped: a file that shrinks would be a signal
    if (!file || !last_complaint.empty())
        refuse(fmt::format("'{}' is no TIFF file, or a truncated one{}", path.filename().string(), because()));
    return file;
}

void next_page(TIFF* file) {
    last_complaint.clear();
    are_sizes_guessed = false;
    if (!TIFFReadDirectory(file) || !last_complaint.empty())
        refuse("has a page that is damaged or missing, as in a truncated file" + because());
}

TiffPage scan_page(TIFF* file, std::uint64_t file_size) {
    TiffPage page;
    page.are_sizes_guessed = are_sizes_guessed;
    const auto columns = tag<std::uint32_t>(file, TIFFTAG_IMAGEWIDTH, 0),
               rows = tag<std::uint32_t>(file, TIFFTAG_IMAGELENGTH, 0);
    if (columns < 1 || columns > 65535 || rows < 1 || rows > 65535)
        refuse(fmt::format("states pages of {} x {} pixels, not 1..65535", columns, rows));
    page.columns = int(columns);
    page.rows = int(rows);
    page.samples = tag<std::uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL, 1);
    if (page.samples < 1 || page.samples > 16) refuse(fmt::format("has {} values a pixel", page.samples));
    page.type = tiff_type(tag<std::uint16_t>(file, TIFFTAG_BITSPERSAMPLE, 1),
                          tag<std::uint16_t>(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT));
    page.color = color_from(file, page.samples);
    page.values = kept_values(file, page);
    if (char* text = nullptr; TIFFGetField(file, TIFFTAG_IMAGEDESCRIPTION, &text) && text) page.description = text;
    take_resolution(file, page);
    if (!TIFFIsCODECConfigured(tag<std::uint16_t>(file, TIFFTAG_COMPRESSION, COMPRESSION_NONE)))
        refuse(fmt::format("is compressed in a way ({}) that is not read",
                           tag<std::uint16_t>(file, TIFFTAG_COMPRESSION, 1)));
    check_capacity(file, page, file_size);
    return page;
}

PixelBox strip_of(TIFF* file, const TiffPage& page) {
    const auto width = std::uint32_t(page.columns), height = std::uint32_t(page.rows);
    const bool is_tiled = TIFFIsTiled(file);
    const auto columns = is_tiled ? tag<std::uint32_t>(file, TIFFTAG_TILEWIDTH, 0) : width,
               rows = is_tiled ? tag<std::uint32_t>(file, TIFFTAG_TILELENGTH, 0)
                               : std::min(tag<std::uint32_t>(file, TIFFTAG_ROWSPERSTRIP, height), height);
    if (rows == 0 || columns == 0) refuse("has strips or tiles of no size");
    constexpr std::uint32_t most = 1 << 24;  // of which no product overflows
    if (rows > most || columns > most) refuse(fmt::format("has tiles of {} x {} pixels", columns, rows));
    return {.columns = int(columns), .rows = int(rows)};
}

std::uint64_t strip_bytes(TIFF* file) {
    return std::uint64_t(std::max<tmsize_t>(TIFFIsTiled(file) ? TIFFTileSize(file) : TIFFStripSize(file), 0));
}

void put_pixels(const TiffPage& page, const PixelBox& stored, const std::byte* from, int samples, int sample,
                const PixelBox& box, const PixelTarget& target) {
    const int left = std::max(stored.column, box.column), top = std::max(stored.row, box.row),
              right = std::min(stored.column + stored.columns, box.column + box.columns),
              bottom = std::min(stored.row + stored.rows, box.row + box.rows);
    const int begin = std::max(target.first, sample), end = std::min(target.first + target.count, sample + samples);
    with_voxel_type(page.type, [&](auto zero) {
        using T = decltype(zero);
        for (int row = top; row < bottom; ++row) {
            const std::size_t at = std::size_t(row - stored.row) * std::size_t(stored.columns);
            const T* pixel =
                reinterpret_cast<const T*>(from) + (at + std::size_t(left - stored.column)) * std::size_t(samples);
            T* to = reinterpret_cast<T*>(target.to) + std::size_t(row - box.row) * target.line +
                    std::size_t(left - box.column) * target.pixel;
            for (int column = left; column < right; ++column, pixel += samples, to += target.pixel)
                for (int v = begin; v < end; ++v) to[v - target.first] = value_of(pixel[v - sample], page.color);
        }
    });
}

void read_pixels(TIFF* file, const TiffPage& page, const PixelBox& box, const PixelTarget& target) {
    const bool are_planes =
                   tag<std::uint16_t>(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE,
               is_tiled = TIFFIsTiled(file);
    const PixelBox size = strip_of(file, page);
    const std::uint32_t across = std::uint32_t((page.columns - 1) / size.columns + 1),
                        down = std::uint32_t((page.rows - 1) / size.rows + 1);
    const std::size_t pixel_bytes = size_of(page.type) * std::size_t(are_planes ? 1 : page.samples);
    std::vector<std::byte> packed(strip_bytes(file));
    PixelBox strip = size;
    const auto take = [&](int plane) {
        const int rows = is_tiled ? size.rows : std::min(size.rows, page.rows - strip.row);
        const std::uint32_t index = (std::uint32_t(plane) * down + std::uint32_t(strip.row / size.rows)) * across +
                                    std::uint32_t(strip.column / size.columns);
        const std::size_t needed = pixel_bytes * std::size_t(size.columns) * std::size_t(rows);
        if (index >= chunks_of(file) || needed > packed.size()) refuse("has fewer strips or tiles than its size needs");
        last_complaint.clear();
        const tmsize_t got = is_tiled ? TIFFReadEncodedTile(file, index, packed.data(), tmsize_t(needed))
                                      : TIFFReadEncodedStrip(file, index, packed.data(), tmsize_t(needed));
        if (got < 0 || std::size_t(got) < needed || !last_complaint.empty())
            refuse("holds pixels that are damaged or missing" + because());
        put_pixels(page, strip, packed.data(), are_planes ? 1 : page.samples, plane, box, target);
    };
    const int first_plane = are_planes ? target.first : 0, end_plane = are_planes ? target.first + target.count : 1;
    for (int plane = first_plane; plane < end_plane; ++plane)
        for (strip.row = box.row / size.rows * size.rows; strip.row < box.row + box.rows; strip.row += size.rows)
            for (strip.column = box.column / size.columns * size.columns; strip.column < box.column + box.columns;
                 strip.column += size.columns)
                take(plane);
}

}  // namespace chiaro::decode
