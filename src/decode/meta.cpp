// MetaImage (https://itk.org/Wiki/ITK/MetaIO/Documentation).
//
// World frame: MetaImage positions are LPS by ITK's convention, but many writers that know nothing of anatomy leave
// AnatomicalOrientation out or say ???. So a frame is claimed only where AnatomicalOrientation names one.
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/text.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <cmath>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

struct MetaHeader {
    Fields fields;
    std::vector<std::string> lines_after;  ///< of `ElementDataFile = LIST`
    std::uint64_t data_offset = 0;         ///< first byte behind `ElementDataFile = LOCAL`
};

MetaHeader read_header(const Path& path) {
    std::string text(1 << 18, '\0');
    text.resize(open_plain(path)->read(std::as_writable_bytes(std::span(text))));
    MetaHeader header;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find('\n', at), text.size());
        const std::string_view line = std::string_view(text).substr(at, end - at);
        at = end + 1;
        if (header.fields.contains("ElementDataFile")) {
            if (!trimmed(line).empty()) header.lines_after.push_back(trimmed(line));
            continue;
        }
        const auto equals = line.find('=');
        if (equals == std::string_view::npos) {
            if (trimmed(line).empty()) continue;
            refuse("is no MetaImage: its header has a line that is not 'name = value'");
        }
        const std::string name = trimmed(line.substr(0, equals));
        if (!header.fields.emplace(name, trimmed(line.substr(equals + 1))).second)
            refuse(fmt::format("its header states '{}' twice", name.substr(0, 40)));
        if (name != "ElementDataFile") continue;
        header.data_offset = at;
        if (!header.fields[name].starts_with("LIST")) return header;
    }
    required(header.fields, "ElementDataFile");
    return header;
}

VoxelType meta_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types = {
        {"MET_UCHAR", VoxelType::u8},      {"MET_CHAR", VoxelType::i8},   {"MET_USHORT", VoxelType::u16},
        {"MET_SHORT", VoxelType::i16},     {"MET_UINT", VoxelType::u32},  {"MET_INT", VoxelType::i32},
        {"MET_ULONG", VoxelType::u32},     {"MET_LONG", VoxelType::i32},  {"MET_ULONG_LONG", VoxelType::u64},
        {"MET_LONG_LONG", VoxelType::i64}, {"MET_FLOAT", VoxelType::f32}, {"MET_DOUBLE", VoxelType::f64}};
    std::string scalar = name;
    if (scalar.ends_with("_ARRAY")) scalar.resize(scalar.size() - 6);
    const auto found = types.find(scalar);
    if (found == types.end()) refuse("its ElementType is '" + name + "', which is not one of MET_CHAR to MET_DOUBLE");
    return found->second;
}

/// Sets the shape and returns how many volumes there are behind each other.
std::uint64_t set_shape(const Fields& fields, Volume& volume) {
    const auto sizes = integers(required(fields, "DimSize"), "DimSize");
    const auto dimension = integer(required(fields, "NDims"), "NDims");
    if (dimension < 2 || dimension > 4 || sizes.size() != std::size_t(dimension))
        refuse(fmt::format("states NDims {} and {} sizes; volumes have 3", dimension, sizes.size()));
    const std::array<std::int64_t, 3> n{sizes[0], sizes[1], dimension > 2 ? sizes[2] : 1};
    const auto components = integer(value_or(fields, "ElementNumberOfChannels", "1"), "ElementNumberOfChannels");
    volume.type = meta_type(required(fields, "ElementType"));
    checked_bytes(n, components, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    volume.components = int(components);
    volume.has_own_colors = are_colors_untold(volume);
    if (dimension == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
    const std::int64_t volumes = dimension == 4 ? sizes[3] : 1;
    if (volumes < 1) refuse(fmt::format("states {} volumes", volumes));
    if (volumes > 1) volume.notes.push_back(fmt::format("holds {} volumes; the first is taken", volumes));
    return std::uint64_t(volumes);
}

/// The first of several spellings that is there.
std::string first_of(const Fields& fields, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (fields.contains(name)) return fields.at(name);
    return {};
}

/// The LPS direction that a letter of AnatomicalOrientation stands for. It names where an axis comes FROM: R runs to
/// the left.
Vec3 direction_of(char letter) {
    switch (letter) {
        case 'R':
            return {1, 0, 0};
        case 'L':
            return {-1, 0, 0};
        case 'A':
            return {0, 1, 0};
        case 'P':
            return {0, -1, 0};
        case 'I':
            return {0, 0, 1};
        case 'S':
            return {0, 0, -1};
        default:
            return {0, 0, 0};
    }
}

/// Steps of the index axes: the rows of TransformMatrix times the spacing, or what AnatomicalOrientation says alone.
void set_directions(const Fields& fields, std::size_t dimension, Volume& volume) {
    Geometry& geometry = volume.geometry;
    const std::string letters = value_or(fields, "AnatomicalOrientation");
    std::array<Vec3, 3> stated;
    for (int axis = 0; axis < 3 && letters.size() == 3; ++axis) stated[axis] = direction_of(letters[std::size_t(axis)]);
    const bool anatomical = std::abs(dot(stated[0], cross(stated[1], stated[2]))) > 0.5;
    if (anatomical) geometry.world = World::lps;
    const auto matrix = numbers(first_of(fields, {"TransformMatrix", "Rotation", "Orientation"}), "TransformMatrix");
    if (matrix.empty()) {
        if (anatomical) geometry.direction = stated;
        return;
    }
    if (matrix.size() != dimension * dimension)
        refuse(fmt::format("its TransformMatrix has {} numbers, not {}", matrix.size(), dimension * dimension));
    std::array<Vec3, 3> steps = geometry.direction;
    for (std::size_t row = 0; row < std::min<std::size_t>(3, dimension); ++row)
        for (std::size_t column = 0; column < 3; ++column)
            steps[row][int(column)] = column < dimension ? matrix[row * dimension + column] : 0;
    for (int axis = 0; axis < 3; ++axis) steps[axis] = geometry.spacing_mm[axis] * steps[axis];
    set_steps(geometry, steps);
    for (int axis = 0; axis < 3 && anatomical; ++axis)
        if (dot(stated[axis], geometry.direction[axis]) < 0.5)
            return volume.notes.push_back("AnatomicalOrientation '" + letters +
                                          "' contradicts TransformMatrix, which is followed");
}

void set_geometry(const Fields& fields, Volume& volume) {
    const auto dimension = std::size_t(integer(required(fields, "NDims"), "NDims"));
    const auto spacing = numbers(first_of(fields, {"ElementSpacing", "ElementSize"}), "ElementSpacing");
    const auto origin = numbers(first_of(fields, {"Offset", "Position", "Origin"}), "Offset");
    if (!spacing.empty() && spacing.size() != dimension)
        refuse(fmt::format("its ElementSpacing has {} numbers", spacing.size()));
    if (!origin.empty() && origin.size() != dimension) refuse(fmt::format("its Offset has {} numbers", origin.size()));
    for (std::size_t i = 0; i < std::min<std::size_t>(3, dimension); ++i) {
        if (!spacing.empty()) volume.geometry.spacing_mm[int(i)] = spacing[i];
        if (!origin.empty()) volume.geometry.origin_mm[int(i)] = origin[i];
    }
    check_geometry(volume.geometry);
    set_directions(fields, dimension, volume);
}

std::vector<Path> data_files(const MetaHeader& header, const Path& path) {
    const std::string& field = header.fields.at("ElementDataFile");
    if (field == "LOCAL" || field == "Local" || field == "local") return {path};
    std::vector<std::string> names{field};
    if (const auto parts = words(field); field.starts_with("LIST"))
        names = header.lines_after;
    else if (parts.size() >= 3 && parts[0].find('%') != std::string::npos)
        names = expand_pattern(parts[0], integer(parts[1], "ElementDataFile"), integer(parts[2], "ElementDataFile"),
                               parts.size() > 3 ? integer(parts[3], "ElementDataFile") : 1);
    std::vector<Path> files;
    for (const auto& name : names) files.push_back(confined(path, name));
    return files;
}

Payload payload_from(const MetaHeader& header, const Path& path, const Volume& volume, std::uint64_t volumes) {
    const Fields& fields = header.fields;
    Payload payload;
    payload.files = data_files(header, path);
    if (payload.files.empty()) refuse("lists no data files");
    const bool local = payload.files[0] == path;
    const bool compressed = boolean(value_or(fields, "CompressedData", "False"), "CompressedData");
    const bool binary = boolean(value_or(fields, "BinaryData", "True"), "BinaryData");
    payload.encoding = !binary ? Encoding::text : compressed ? Encoding::deflated : Encoding::raw;
    const std::string msb = first_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    payload.big_endian = !msb.empty() && boolean(msb, "BinaryDataByteOrderMSB");
    payload.volumes = volumes;
    payload.offset = local ? header.data_offset : 0;
    if (const auto skip = integer(value_or(fields, "HeaderSize", "0"), "HeaderSize"); skip == -1) {
        const auto& n = volume.dimensions;
        const auto bytes =
            checked_bytes({n[0], n[1], n[2]}, volume.components, volume.type) * volumes / payload.files.size();
        const auto size = regular_file_size(payload.files[0]);
        payload.offset = size - std::min(size, bytes);
    } else if (skip >= 0) {
        payload.offset += std::uint64_t(skip);
    } else {
        refuse(fmt::format("states the HeaderSize {}, which is neither -1 nor a number of bytes", skip));
    }
    return payload;
}

/// What the header says beyond the image itself.
void set_words(const Fields& fields, Volume& volume) {
    for (const char* name : {"Comment", "Name", "SeriesDescription", "StudyDate", "Modality"})
        if (fields.contains(name)) volume.key_values[name] = fields.at(name);
    const std::string modality = value_or(fields, "Modality");
    if (modality.starts_with("MET_MOD_") && !modality.ends_with("OTHER") && !modality.ends_with("UNKNOWN"))
        volume.modality = modality.substr(8);
    volume.slope = number(value_or(fields, "ElementToIntensityFunctionSlope", "1"), "ElementToIntensityFunctionSlope");
    volume.intercept =
        number(value_or(fields, "ElementToIntensityFunctionOffset", "0"), "ElementToIntensityFunctionOffset");
}

}  // namespace

Volume read_meta(const Path& path, const std::string&, Output& output) {
    const MetaHeader header = read_header(path);
    if (value_or(header.fields, "ObjectType", "Image") != "Image")
        refuse("holds a MetaIO object of type '" + header.fields.at("ObjectType") + "', not an Image");
    Volume volume;
    volume.format = "MetaImage";
    const std::uint64_t volumes = set_shape(header.fields, volume);
    set_geometry(header.fields, volume);
    set_words(header.fields, volume);
    read_voxels(payload_from(header, path, volume, volumes), volume, output);
    return volume;
}

}  // namespace chiaro::decode
