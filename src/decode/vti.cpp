// VTK's XML image data (https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html).
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/text.h"
#include "decode/vti_data.h"
#include "decode/vti_pieces.h"
#include "decode/vtk_arrays.h"
#include "io/xml_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

/// The text up to the appended data, which need not be XML, and where these lie in the file.
struct VtiText {
    std::string xml;
    std::string appended_encoding;  ///< empty: there are none
    std::uint64_t appended_at = 0;
};

std::string text_until(const Path& path, std::string_view mark) {
    const auto source = open_plain(path);
    std::string text;
    constexpr std::size_t piece = 1 << 20;
    for (std::size_t got = piece, searched = 0; got == piece;) {
        const std::size_t before = text.size();
        text.resize(before + piece);
        got = source->read(std::as_writable_bytes(std::span(text).subspan(before)));
        text.resize(before + got);
        if (before == 0 && text.find("<VTKFile") == std::string::npos) refuse("is no VTK XML file: it has no VTKFile");
        if (text.find(mark, searched) != std::string::npos) break;
        searched = text.size() - std::min(text.size(), mark.size());
    }
    return text;
}

/// Appended data may be whole where the file is not, but then who knows what else it lacks.
void check_end(const Path& path) {
    const auto size = regular_file_size(path);
    std::string tail(std::min<std::uint64_t>(size, 4096), '\0');
    tail.resize(open_plain(path, size - tail.size())->read(std::as_writable_bytes(std::span(tail))));
    if (tail.find("</VTKFile>") == std::string::npos) refuse("does not end with '</VTKFile>': the file is truncated");
}

VtiText read_text(const Path& path) {
    VtiText result;
    result.xml = text_until(path, "<AppendedData");
    const auto mark = result.xml.find("<AppendedData");
    if (mark == std::string::npos) return result;
    check_end(path);
    const auto end = result.xml.find('>', mark), start = result.xml.find_first_not_of(" \t\r\n", end + 1);
    if (end == std::string::npos || start == std::string::npos || result.xml[start] != '_')
        refuse("has appended data that do not begin with '_'");
    const std::string tag = result.xml.substr(mark, end - mark);
    result.appended_encoding = tag.find("base64") != std::string::npos ? "base64" : "raw";
    result.appended_at = start + 1;
    result.xml.resize(mark);
    result.xml += "</VTKFile>";
    return result;
}

VoxelType vti_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types = {
        {"Int8", VoxelType::i8},     {"UInt8", VoxelType::u8},   {"Int16", VoxelType::i16}, {"UInt16", VoxelType::u16},
        {"Int32", VoxelType::i32},   {"UInt32", VoxelType::u32}, {"Int64", VoxelType::i64}, {"UInt64", VoxelType::u64},
        {"Float32", VoxelType::f32}, {"Float64", VoxelType::f64}};
    const auto found = types.find(name);
    if (found == types.end()) refuse("has an array of type '" + name + "', which is not one from Int8 to Float64");
    return found->second;
}

std::string attribute(const pugi::xml_node& node, const char* name, const std::string& fallback) {
    return node.attribute(name).as_string(fallback.c_str());
}

VtiCoding coding_of(const pugi::xml_node& file) {
    VtiCoding coding;
    const std::string order = attribute(file, "byte_order", "LittleEndian"),
                      header = attribute(file, "header_type", "UInt32");
    if (order != "LittleEndian" && order != "BigEndian") refuse("states the byte order '" + order + "'");
    if (header != "UInt32" && header != "UInt64") refuse("states the header type '" + header + "'");
    coding.big_endian = order == "BigEndian";
    coding.wide_header = header == "UInt64";
    coding.compressor = attribute(file, "compressor", "");
    return coding;
}

/// Points along each axis; sets the geometry.
std::array<std::int64_t, 3> set_geometry(const pugi::xml_node& image, Volume& volume) {
    const auto extent = integers(attribute(image, "WholeExtent", ""), "WholeExtent");
    return set_place({.extent = {extent.begin(), extent.end()},
                      .origin = numbers(attribute(image, "Origin", "0 0 0"), "Origin"),
                      .spacing = numbers(attribute(image, "Spacing", "1 1 1"), "Spacing"),
                      .direction = numbers(attribute(image, "Direction", "1 0 0 0 1 0 0 0 1"), "Direction")},
                     volume);
}

std::vector<std::pair<VtkArray, pugi::xml_node>> arrays_of(const pugi::xml_node& piece) {
    std::vector<std::pair<VtkArray, pugi::xml_node>> arrays;
    for (const char* of : {"PointData", "CellData"}) {
        const auto data = piece.child(of);
        for (const auto& node : data.children("DataArray")) {
            VtkArray array{.name = attribute(node, "Name", ""), .of_cells = std::string_view(of) == "CellData"};
            if (attribute(node, "type", "") == "String") continue;
            array.active = !array.name.empty() && array.name == attribute(data, "Scalars", "");
            array.type = vti_type(attribute(node, "type", ""));
            array.components = integer(attribute(node, "NumberOfComponents", "1"), "NumberOfComponents");
            arrays.emplace_back(array, node);
        }
    }
    return arrays;
}

/// Where the array's stored bytes begin: inline text, or an offset into the appended data; and how many there can be.
std::pair<std::unique_ptr<ByteSource>, std::uint64_t> open_stored(const pugi::xml_node& node, const VtiText& text,
                                                                  const Path& path) {
    const std::string format = attribute(node, "format", "ascii");
    if (format == "binary") {
        const std::string_view inline_text = node.text().get();
        return {open_base64(open_memory(inline_text)), inline_text.size() / 4 * 3};
    }
    if (format != "appended") refuse("has an array of format '" + format + "', not ascii, binary or appended");
    if (text.appended_encoding.empty()) refuse("has an array that is appended, but no appended data");
    const auto offset = integer(attribute(node, "offset", ""), "offset");
    const auto size = regular_file_size(path), room = size - std::min(size, text.appended_at);
    if (offset < 0 || std::uint64_t(offset) >= room)
        refuse(fmt::format("has an array at offset {} of its {} bytes of appended data: truncated, or a wrong header",
                           offset, room));
    auto source = open_plain(path, text.appended_at + std::uint64_t(offset));
    if (text.appended_encoding == "raw") return {std::move(source), room - std::uint64_t(offset)};
    return {open_base64(std::move(source)), (room - std::uint64_t(offset)) / 4 * 3};
}

void fill(const pugi::xml_node& node, const VtiText& text, const Path& path, const VtiCoding& coding,
          std::uint64_t bytes, Volume& volume, Output& output) {
    const auto voxels = [&] {
        output.allocate(volume);
        return std::span(volume.voxels.data(), volume.voxels.size());
    };
    if (attribute(node, "format", "ascii") == "ascii") {
        const std::string_view inline_text = node.text().get();
        check_capacity(bytes, (inline_text.size() + 1) / 2 * size_of(volume.type));
        // Its end tag proves it whole.
        if (fill_from_text(*open_memory(inline_text), volume.type, voxels(), output).has_more)
            volume.notes.push_back("there are more numbers in the array than voxels; they are ignored");
        return;
    }
    auto [stored, available] = open_stored(node, text, path);
    const auto source = open_vti_array(std::move(stored), coding, bytes, available);
    fill_from_bytes(*source, coding.big_endian, volume.type, voxels(), output);
}

/// What a file may be where another one names it.
enum class Level { image, pieces, collection };

Volume read_image(const Path& path, const VtiText& text, const pugi::xml_node& file, Output& output) {
    const auto image = file.child("ImageData"), piece = image.child("Piece");
    if (!piece) refuse("has no piece of image data");
    if (piece.next_sibling("Piece")) refuse("has its image in several pieces; one is read");
    Volume volume;
    volume.format = "VTK";
    const auto points = set_geometry(image, volume);
    const std::string whole = attribute(image, "WholeExtent", "");
    if (integers(attribute(piece, "Extent", whole), "Extent") != integers(whole, "WholeExtent"))
        refuse("has a piece that is not its whole extent");
    const auto nodes = arrays_of(piece);
    std::vector<VtkArray> arrays;
    for (const auto& [array, node] : nodes) arrays.push_back(array);
    const std::size_t chosen = choose_array(arrays, volume);
    const auto bytes = set_shape(arrays[chosen], points, volume);
    fill(nodes[chosen].second, text, path, coding_of(file), bytes, volume, output);
    return volume;
}

Volume read_xml(const Path& path, Level level, Output& output) {
    VtiText text = read_text(path);
    pugi::xml_document document;
    const auto parsed = document.load_buffer_inplace(
        text.xml.data(), text.xml.size(), pugi::parse_escapes | pugi::parse_declaration, pugi::encoding_utf8);
    if (parsed.status == pugi::status_out_of_memory) throw std::bad_alloc();
    if (!parsed) refuse(fmt::format("its XML is damaged or truncated: {}", parsed.description()));
    if (const auto twice = attribute_stated_twice(document); !twice.empty())
        refuse("its XML states " + twice + " twice");
    const auto file = document.child("VTKFile");
    const std::string type = attribute(file, "type", "");
    if (type == "ImageData") return read_image(path, text, file, output);
    const auto named_as = [](Level most) {
        return [most](const Path& named, Output& to) { return read_xml(named, most, to); };
    };
    if (type == "PImageData" && level >= Level::pieces) {
        const auto image = file.child("PImageData");
        Volume whole;
        whole.format = "VTK";
        const auto points = set_geometry(image, whole);
        return read_pieces(path, image, points, std::move(whole), output, named_as(Level::image));
    }
    if (type == "Collection" && level == Level::collection)
        return read_collection(path, file.child("Collection"), output, named_as(Level::pieces));
    refuse("holds VTK data of type '" + type + "', not ImageData");
}

}  // namespace

Volume read_vti(const Path& path, const std::string&, Output& output) {
    return read_xml(path, Level::collection, output);
}

}  // namespace chiaro::decode
