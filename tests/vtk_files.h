// Small VTK files, written byte by byte.
#pragma once
#include "volume_files.h"

namespace volume_files {

inline std::string base64(const std::string& bytes) {
    const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) { return k < bytes.size() ? unsigned(std::uint8_t(bytes[k])) : 0U; };
        const unsigned bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        for (int k = 0; k < 4; ++k)
            text += i + std::size_t(k) > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

/// An array of a .vti file: its values as bytes (in the file's byte order), or as text for `ascii`.
struct VtiArray {
    std::string type = "UInt8", name = "density", values = std::string("abcdefghijklmnopqrstuvwx");
    int components = 1;
    bool of_cells = false;
};

/// Image data of 4 x 3 x 2 points.
struct Vti {
    std::vector<VtiArray> arrays{VtiArray{}};
    std::string format = "appended", encoding = "raw";  ///< of the appended data
    std::string extent = "0 3 0 2 0 1", scalars = "", more = R"( Origin="1 2 3" Spacing="0.5 2 3")";
    bool big_endian = false, wide_header = false;
    std::string compressor;                                 ///< as VTK names it
    std::string (*compress)(const std::string&) = nullptr;  ///< of one block
    std::size_t block = 10;

    std::string bytes() const {
        std::string appended;
        const auto data = [&](bool of_cells) {
            std::string xml;
            for (const auto& array : arrays) {
                if (array.of_cells != of_cells) continue;
                xml += "<DataArray type=\"" + array.type + "\" Name=\"" + array.name + "\" NumberOfComponents=\"" +
                       std::to_string(array.components) + "\" format=\"" + format + "\"";
                if (format == "appended") xml += " offset=\"" + std::to_string(appended.size()) + "\"/>\n";
                if (format == "ascii") xml += ">\n" + array.values + "\n</DataArray>\n";
                if (format == "binary") xml += ">\n  " + coded(array.values, true) + "\n</DataArray>\n";
                if (format == "appended") appended += coded(array.values, encoding == "base64");
            }
            return xml;
        };
        std::string xml =
            std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\"") + " byte_order=\"" +
            (big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"" + (wide_header ? "UInt64" : "UInt32") +
            "\"" + (compressor.empty() ? "" : " compressor=\"" + compressor + "\"") + ">\n<ImageData WholeExtent=\"" +
            extent + "\"" + more + ">\n<Piece Extent=\"" + extent + "\">\n<PointData" +
            (scalars.empty() ? "" : " Scalars=\"" + scalars + "\"") + ">\n" + data(false) +
            "</PointData>\n<CellData>\n" + data(true) + "</CellData>\n</Piece>\n</ImageData>\n";
        if (format == "appended")
            xml += "<AppendedData encoding=\"" + encoding + "\">\n_" + appended + "\n</AppendedData>\n";
        return xml + "</VTKFile>";
    }

    std::string count(std::uint64_t value) const {
        return wide_header ? bytes_of(value, big_endian) : bytes_of(std::uint32_t(value), big_endian);
    }

private:
    std::string coded(const std::string& values, bool as_text) const {
        const auto text = [&](const std::string& raw) { return as_text ? base64(raw) : raw; };
        if (!compress) return text(count(values.size()) + values);
        std::vector<std::string> blocks;
        for (std::size_t at = 0; at < values.size(); at += block) blocks.push_back(compress(values.substr(at, block)));
        std::string header = count(blocks.size()) + count(block) + count(values.size() % block), all;
        for (const auto& packed : blocks) {
            header += count(packed.size());
            all += packed;
        }
        return text(header) + text(all);
    }
};

/// The start of a legacy file of 4 x 3 x 2 points, up to its data.
inline std::string vtk_start(bool binary, const std::string& kind = "STRUCTURED_POINTS") {
    return std::string("# vtk DataFile Version 3.0\na title\n") + (binary ? "BINARY" : "ASCII") + "\nDATASET " + kind +
           "\nDIMENSIONS 4 3 2\nORIGIN 1 2 3\nSPACING 0.5 2 3\n";
}

inline std::string vtk_scalars(const std::string& type, const std::string& values) {
    return "SCALARS density " + type + "\nLOOKUP_TABLE default\n" + values;
}

/// A valid binary file.
inline std::string vtk_file() {
    return vtk_start(true) + "POINT_DATA 24\n" + vtk_scalars("short", bytes_of_all(ramp<std::int16_t>(24, -7), true));
}

}  // namespace volume_files
