// Stacks of TIFF pages, written by its library.
#pragma once
#include "volume_files.h"

#include <tiffio.h>

#include <functional>
#include <type_traits>

namespace volume_files {

/// How a page is stored.
struct TiffStorage {
    int compression = COMPRESSION_NONE;
    bool tiled = false, planes = false;
    int samples = 1, predictor = 1;
    const char* mode = "w";  ///< w8: BigTIFF; wb: big endian
    int alpha = 0;           ///< what the last sample is, as EXTRASAMPLES has it
    int columns = 16;        ///< of a tile
    int rows = 0;            ///< of a tile or a strip; 0: 32 or 8
};

template <class T>
using TiffValue = std::function<T(int x, int y, int z, int sample)>;

/// Sets what the current page is.
template <class T>
void describe_page(TIFF* file, const TiffStorage& storage, int width, int height, int chunk_width, int chunk_height) {
    TIFFSetField(file, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(file, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 8 * sizeof(T));
    TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, storage.samples);
    TIFFSetField(file, TIFFTAG_SAMPLEFORMAT,
                 std::is_floating_point_v<T> ? SAMPLEFORMAT_IEEEFP
                 : std::is_signed_v<T>       ? SAMPLEFORMAT_INT
                                             : SAMPLEFORMAT_UINT);
    TIFFSetField(file, TIFFTAG_PHOTOMETRIC, storage.samples > 2 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(file, TIFFTAG_PLANARCONFIG, storage.planes ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    const std::uint16_t extra[] = {std::uint16_t(storage.alpha)};
    if (storage.alpha) TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, extra);
    TIFFSetField(file, TIFFTAG_COMPRESSION, storage.compression);
    if (storage.predictor > 1) TIFFSetField(file, TIFFTAG_PREDICTOR, storage.predictor);
    if (storage.tiled) {
        TIFFSetField(file, TIFFTAG_TILEWIDTH, chunk_width);
        TIFFSetField(file, TIFFTAG_TILELENGTH, chunk_height);
    } else {
        TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, chunk_height);
    }
}

/// A file of pages; `size`: columns, rows, pages.
template <class T>
void write_tiff(const std::string& name, const TiffStorage& storage, const std::array<int, 3>& size,
                const TiffValue<T>& value) {
    const auto [width, height, pages] = size;
    const int chunk_width = storage.tiled ? storage.columns : width, chunk_height = storage.rows    ? storage.rows
                                                                                    : storage.tiled ? 32
                                                                                                    : 8;
    TIFF* file = TIFFOpen(name.c_str(), storage.mode);
    for (int z = 0; z < pages; ++z) {
        describe_page<T>(file, storage, width, height, chunk_width, chunk_height);
        std::uint32_t index = 0;
        for (int plane = 0; plane < (storage.planes ? storage.samples : 1); ++plane)
            for (int top = 0; top < height; top += chunk_height)
                for (int left = 0; left < width; left += chunk_width) {
                    std::vector<T> chunk;
                    const int rows = storage.tiled ? chunk_height : std::min(chunk_height, height - top);
                    for (int y = top; y < top + rows; ++y)
                        for (int x = left; x < left + chunk_width; ++x)
                            for (int s = 0; s < (storage.planes ? 1 : storage.samples); ++s)
                                chunk.push_back(value(x, y, z, storage.planes ? plane : s));
                    const auto bytes = tmsize_t(chunk.size() * sizeof(T));
                    storage.tiled ? TIFFWriteEncodedTile(file, index, chunk.data(), bytes)
                                  : TIFFWriteEncodedStrip(file, index, chunk.data(), bytes);
                    ++index;
                }
        TIFFWriteDirectory(file);
    }
    TIFFClose(file);
}

}  // namespace volume_files
