// Small TIFF files, written byte by byte (TIFF 6.0, uncompressed, one strip a page).
#pragma once
#include "volume_files.h"

namespace volume_files {

/// One page of 4 x 3 pixels.
struct TiffImage {
    std::string pixels = bytes_of_all(ramp<std::uint16_t>(12));
    int columns = 4, rows = 3, bits = 16, samples = 1;
    int format = 1;       ///< 1 without sign, 2 with sign, 3 float
    int photometric = 1;  ///< 0 white is zero, 1 black is zero, 2 RGB, 3 palette
    std::string description;
    double x_resolution = 0, y_resolution = 0;
    int unit = 1;          ///< 1 none, 2 inch, 3 centimetre
    bool reduced = false;  ///< a thumbnail
};

/// A file of these pages; `after` follows the last one, which large stacks of ImageJ need.
inline std::string tiff_file(const std::vector<TiffImage>& pages, bool big_endian = false,
                             const std::string& after = {}) {
    const auto u16 = [&](int value) { return bytes_of(std::uint16_t(value), big_endian); };
    const auto u32 = [&](std::size_t value) { return bytes_of(std::uint32_t(value), big_endian); };
    std::string file = std::string(big_endian ? "MM" : "II") + u16(42) + u32(8);
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const TiffImage& page = pages[i];
        std::vector<std::string> entries;
        std::string extra;
        const std::size_t count = 10 + std::size_t(!page.description.empty()) + 3 * std::size_t(page.x_resolution > 0) +
                                  std::size_t(page.reduced);
        const std::size_t extra_at = file.size() + 2 + 12 * count + 4;
        const auto entry = [&](int tag, int type, std::size_t n, const std::string& value) {
            std::string field = value;
            if (field.size() > 4) {
                field = u32(extra_at + extra.size());
                extra += value + std::string(value.size() % 2, '\0');
            }
            field.resize(4);
            entries.push_back(u16(tag) + u16(type) + u32(n) + field);
        };
        const auto ratio = [&](double value) { return u32(std::size_t(value * 1000)) + u32(1000); };
        std::string all_bits;
        for (int s = 0; s < page.samples; ++s) all_bits += u16(page.bits);
        if (page.reduced) entry(254, 4, 1, u32(1));
        entry(256, 4, 1, u32(std::size_t(page.columns)));
        entry(257, 4, 1, u32(std::size_t(page.rows)));
        entry(258, 3, std::size_t(page.samples), all_bits);
        entry(259, 3, 1, u16(1));
        entry(262, 3, 1, u16(page.photometric));
        if (!page.description.empty()) entry(270, 2, page.description.size() + 1, page.description + '\0');
        entry(273, 4, 1, std::string(4, '\0'));  // set below, once the length of everything before is known
        const std::size_t strip_offset = entries.size() - 1;
        entry(277, 3, 1, u16(page.samples));
        entry(278, 4, 1, u32(std::size_t(page.rows)));
        entry(279, 4, 1, u32(page.pixels.size()));
        if (page.x_resolution > 0) {
            entry(282, 5, 1, ratio(page.x_resolution));
            entry(283, 5, 1, ratio(page.y_resolution));
            entry(296, 3, 1, u16(page.unit));
        }
        entry(339, 3, std::size_t(page.samples), [&] {
            std::string formats;
            for (int s = 0; s < page.samples; ++s) formats += u16(page.format);
            return formats;
        }());
        const std::size_t pixels_at = extra_at + extra.size();
        entries[strip_offset].replace(8, 4, u32(pixels_at));
        std::string pixels = page.pixels;
        pixels.resize(pixels.size() + pixels.size() % 2);
        file += u16(int(entries.size()));
        for (const auto& each : entries) file += each;
        file += u32(i + 1 < pages.size() ? pixels_at + pixels.size() : 0) + extra;
        file += i + 1 < pages.size() ? pixels : page.pixels + after;
    }
    return file;
}

/// The first of two channels; the second lies in "c2.tif".
inline std::string ome_file() {
    TiffImage first;
    first.description =
        R"(<OME><Image><Pixels SizeZ="1" SizeC="2"><TiffData FirstC="0"><UUID FileName="c1.tif">1</UUID></TiffData>)"
        R"(<TiffData FirstC="1"><UUID FileName="c2.tif">2</UUID></TiffData></Pixels></Image></OME>)";
    return tiff_file({first});
}

}  // namespace volume_files
