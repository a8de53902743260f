#include "hostile/header_edits.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <string_view>

#include "vdb_bytes.h"

namespace hostile {
namespace {

std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t size, bool big_endian = false) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
        value |= std::uint64_t(std::uint8_t(bytes[at + i])) << 8 * (big_endian ? size - 1 - i : i);
    return value;
}

std::vector<BinaryField> nifti_fields(const std::string& bytes) {
    const bool big = number_at(bytes, 0, 4) != 348;
    std::vector<BinaryField> fields{{0, 4, false, big}};
    const auto add = [&](std::size_t from, std::size_t count, std::size_t size, bool is_real) {
        for (std::size_t i = 0; i < count; ++i) fields.push_back({from + i * size, size, is_real, big});
    };
    add(40, 8, 2, false);   // dim
    add(70, 2, 2, false);   // datatype, bitpix
    add(76, 11, 4, true);   // pixdim, vox_offset, scl_slope, scl_inter
    add(123, 1, 1, false);  // xyzt_units
    add(252, 2, 2, false);  // qform_code, sform_code
    add(256, 18, 4, true);  // quaternion, offset, srow
    return fields;
}

std::vector<BinaryField> tiff_fields(const std::string& bytes) {
    const bool big = bytes.substr(0, 2) == "MM";
    std::vector<BinaryField> fields{{4, 4, false, big}};
    for (std::size_t at = number_at(bytes, 4, 4, big), pages = 0; at && at + 2 < bytes.size() && pages < 16; ++pages) {
        const std::size_t count = number_at(bytes, at, 2, big);
        fields.push_back({at, 2, false, big});
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t entry = at + 2 + 12 * i, type = number_at(bytes, entry + 2, 2, big);
            fields.push_back({entry + 2, 2, false, big});
            fields.push_back({entry + 4, 4, false, big});
            fields.push_back({entry + 8, type == 3 ? 2u : 4u, false, big});
        }
        fields.push_back({at + 2 + 12 * count, 4, false, big});
        at = number_at(bytes, at + 2 + 12 * count, 4, big);
    }
    return fields;
}

/// An element of DICOM, explicit VR, little endian.
struct Element {
    std::size_t at;
    std::string vr;
    BinaryField length;
    std::size_t value, end;
};

std::vector<Element> dicom_elements(const std::string& bytes) {
    std::vector<Element> elements;
    for (std::size_t at = 132; at + 8 <= bytes.size(); at = elements.back().end) {
        const std::string vr = bytes.substr(at + 4, 2);
        const bool is_long = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN";
        const BinaryField length{at + (is_long ? 8 : 6), is_long ? 4u : 2u};
        const std::size_t value = length.at + length.size;
        elements.push_back({at, vr, length, value, value + number_at(bytes, length.at, length.size)});
    }
    return elements;
}

/// Lengths of all elements, and the numbers of two bytes.
std::vector<BinaryField> dicom_fields(const std::string& bytes) {
    std::vector<BinaryField> fields;
    for (const Element& element : dicom_elements(bytes)) {
        fields.push_back(element.length);
        if (element.vr == "US") fields.push_back({element.value, 2});
    }
    return fields;
}

/// Elements whose numbers are text.
std::vector<TextField> dicom_texts(const std::string& bytes) {
    std::vector<TextField> fields;
    for (const Element& element : dicom_elements(bytes))
        if (element.vr == "DS" || element.vr == "IS")
            fields.push_back({element.at, element.end, element.value, element.end, true});
    return fields;
}

/// Words that may be sizes or addresses: not zero, and not far beyond the file.
std::vector<BinaryField> hdf5_fields(const std::string& bytes) {
    std::vector<BinaryField> fields;
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += 4)
        for (const std::size_t size : {std::size_t(8), std::size_t(4)}) {
            const std::uint64_t value = number_at(bytes, at, size);
            if (value != 0 && value <= 4 * bytes.size()) fields.push_back({at, size});
        }
    return fields;
}

/// What stands at the beginning of each part.
std::vector<BinaryField> vdb_fields() {
    std::vector<BinaryField> fields;
    for (const auto& [part, at] : volume_files::VdbBytes().places()) {
        for (const std::size_t size : {std::size_t(4), std::size_t(8)})
            fields.push_back({at, size, part == "background"});
    }
    return fields;
}

std::vector<BinaryField> png_fields(const std::string& bytes) {
    std::vector<BinaryField> fields{{16, 4, false, true}, {20, 4, false, true}, {24, 1}, {25, 1}};
    for (std::size_t at = 8; at + 12 <= bytes.size(); at += 12 + number_at(bytes, at, 4, true))
        fields.push_back({at, 4, false, true});
    return fields;
}

std::vector<BinaryField> first_words(const std::string& bytes) {
    std::vector<BinaryField> fields;
    for (std::size_t at = 0; at + 8 <= std::min<std::size_t>(bytes.size(), 400); ++at) {
        if (at % 8 == 0) fields.push_back({at, 8});
        fields.push_back({at, 4});
    }
    return fields;
}

std::size_t find_or_end(const std::string& text, std::string_view what, std::size_t from = 0) {
    return std::min(text.find(what, from), text.size());
}

/// Each line of a header: KEY SEPARATOR VALUE.
std::vector<TextField> line_fields(const std::string& text, std::size_t end, std::string_view separators) {
    std::vector<TextField> fields;
    for (std::size_t begin = 0; begin < end;) {
        const std::size_t next = std::min(find_or_end(text, "\n", begin) + 1, end);
        const std::size_t separator = text.find_first_of(separators, begin);
        const bool is_user = text.compare(std::min(separator, text.size()), 2, ":=") == 0;
        if (text[begin] != '#' && separator < next) {
            const std::size_t value = std::min(text.find_first_not_of("=: ", separator), next - 1);
            const bool is_factor = text.compare(begin, 8, "EXPOSURE") == 0;  // of Radiance: all are multiplied
            fields.push_back({begin, next, value, next - 1, !is_user && !is_factor});
        }
        begin = next;
    }
    return fields;
}

/// Lines of a VTK file that say something of the grid.
std::vector<TextField> vtk_fields(const std::string& text) {
    std::vector<TextField> fields;
    for (const char* key : {"DIMENSIONS ", "ORIGIN ", "SPACING ", "POINT_DATA ", "SCALARS "}) {
        const std::size_t begin = text.find(key), end = find_or_end(text, "\n", begin);
        if (begin == text.npos || end == text.size()) continue;
        fields.push_back(
            {begin, end + 1, begin + std::strlen(key), end, *key != 'P' && std::strncmp(key, "SC", 2) != 0});
    }
    return fields;
}

/// NAME="VALUE", with the space before it.
std::vector<TextField> xml_fields(const std::string& text) {
    std::vector<TextField> fields;
    for (std::size_t at = 0; (at = text.find("=\"", at)) != text.npos;) {
        const std::size_t end = text.find('"', at + 2), begin = text.find_last_of(" \n", at);
        if (end == text.npos || begin == text.npos) break;
        fields.push_back({begin, end + 1, at + 2, end, true});
        at = end;
    }
    return fields;
}

/// "NAME": VALUE, with the comma behind it where there is one.
std::vector<TextField> json_fields(const std::string& text) {
    std::vector<TextField> fields;
    for (std::size_t at = 0; (at = text.find("\":", at)) != text.npos; ++at) {
        std::size_t end = at + 2;
        for (int depth = 0; end < text.size(); ++end) {
            const char c = text[end];
            if (depth == 0 && (c == ',' || c == '}' || c == ']')) break;
            depth += (c == '[' || c == '{') - (c == ']' || c == '}');
        }
        const std::size_t begin = text.rfind('"', at - 1), value = text.find_first_not_of(' ', at + 2);
        if (begin == text.npos || value == text.npos) break;
        fields.push_back({begin, std::min(end + (text[end] == ','), text.size()), value, end, false});
    }
    return fields;
}

}  // namespace

std::vector<TextField> text_fields(const Seed& seed) {
    const std::string& text = seed.bytes;
    const auto starts = [&](std::string_view start) { return text.starts_with(start); };
    if (starts("NRRD")) return line_fields(text, find_or_end(text, "\n\n") + 1, ":");
    if (starts("ObjectType")) return line_fields(text, find_or_end(text, "ElementDataFile"), "=");
    if (starts("# vtk")) return vtk_fields(text);
    if (starts("#?RADIANCE")) return line_fields(text, find_or_end(text, "+X") + 5, " =");
    if (seed.format == "dicom") return dicom_texts(text);
    if (seed.format == "glow") {
        auto fields = line_fields(text, text.size(), " ");
        for (TextField& field : fields) field.is_single = false;
        return fields;
    }
    if (starts("<")) return xml_fields(text);
    if (starts("{") || starts("[")) return json_fields(text);
    return {};
}

std::vector<BinaryField> binary_fields(const Seed& seed) {
    const std::string& bytes = seed.bytes;
    if (seed.format == "nifti" && bytes.size() >= 348) return nifti_fields(bytes);
    if (seed.format == "tiff") return tiff_fields(bytes);
    if (seed.format == "dicom") return dicom_fields(bytes);
    if (seed.format == "hdf5") return hdf5_fields(bytes);
    if (seed.format == "vdb") return vdb_fields();
    if (bytes.starts_with("\x89PNG")) return png_fields(bytes);
    return first_words(bytes);
}

}  // namespace hostile
