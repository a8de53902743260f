#include "decode/nrrd_header.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

VoxelType nrrd_type(const std::string& name) {
    static const std::map<std::string, VoxelType> types = {{"signed char", VoxelType::i8},
                                                           {"int8", VoxelType::i8},
                                                           {"int8_t", VoxelType::i8},
                                                           {"uchar", VoxelType::u8},
                                                           {"unsigned char", VoxelType::u8},
                                                           {"uint8", VoxelType::u8},
                                                           {"uint8_t", VoxelType::u8},
                                                           {"short", VoxelType::i16},
                                                           {"short int", VoxelType::i16},
                                                           {"signed short", VoxelType::i16},
                                                           {"int16", VoxelType::i16},
                                                           {"int16_t", VoxelType::i16},
                                                           {"signed short int", VoxelType::i16},
                                                           {"ushort", VoxelType::u16},
                                                           {"uint16", VoxelType::u16},
                                                           {"uint16_t", VoxelType::u16},
                                                           {"unsigned short", VoxelType::u16},
                                                           {"unsigned short int", VoxelType::u16},
                                                           {"int", VoxelType::i32},
                                                           {"signed int", VoxelType::i32},
                                                           {"int32", VoxelType::i32},
                                                           {"int32_t", VoxelType::i32},
                                                           {"uint", VoxelType::u32},
                                                           {"unsigned int", VoxelType::u32},
                                                           {"uint32", VoxelType::u32},
                                                           {"uint32_t", VoxelType::u32},
                                                           {"longlong", VoxelType::i64},
                                                           {"long long", VoxelType::i64},
                                                           {"long long int", VoxelType::i64},
                                                           {"signed long long", VoxelType::i64},
                                                           {"signed long long int", VoxelType::i64},
                                                           {"int64", VoxelType::i64},
                                                           {"int64_t", VoxelType::i64},
                                                           {"ulonglong", VoxelType::u64},
                                                           {"unsigned long long", VoxelType::u64},
                                                           {"unsigned long long int", VoxelType::u64},
                                                           {"uint64", VoxelType::u64},
                                                           {"uint64_t", VoxelType::u64},
                                                           {"float", VoxelType::f32},
                                                           {"double", VoxelType::f64}};
    const auto found = types.find(lower(name));
    if (found == types.end())
        refuse("its type is '" + name + "', which is not one of the NRRD types from int8 to double");
    return found->second;
}

/// "(a,b,c)" or "none" for every axis.
std::vector<std::optional<Vec3>> vectors_from(const std::string& text, const std::string& what) {
    std::vector<std::optional<Vec3>> result;
    for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string::npos;) {
        if (text.compare(at, 4, "none") == 0) {
            result.push_back({});
            at += 4;
            continue;
        }
        const auto end = text.find(')', at);
        if (text[at] != '(' || end == std::string::npos)
            refuse(fmt::format("its '{}' is '{}', not vectors", what, text.substr(0, 80)));
        const auto parts = words(text.substr(at + 1, end - at - 1), ",");
        if (parts.size() != 3) refuse(fmt::format("its '{}' has {} numbers in a vector, not 3", what, parts.size()));
        result.push_back(Vec3{number(parts[0], what), number(parts[1], what), number(parts[2], what)});
        at = end + 1;
    }
    return result;
}

/// Which of the file's axes are what.
struct Axes {
    std::vector<std::int64_t> sizes;
    std::size_t first = 0;      ///< the first of the three in space; 1 when values of a voxel come first
    std::size_t spatial = 3;    ///< how many there are in space (2: one slice)
    std::uint64_t volumes = 1;  ///< along the axes behind
};

bool has_list_first(const NrrdHeader& header, std::size_t dimension) {
    if (const auto directions = value_or(header.fields, "space directions"); !directions.empty())
        return directions.starts_with("none");
    const auto kinds = words(value_or(header.fields, "kinds"));
    const auto in_space = [](const std::string& kind) {
        return kind == "domain" || kind == "space" || kind == "time" || kind == "???" || kind == "none";
    };
    return kinds.size() == dimension && !in_space(lower(kinds[0]));
}

Axes find_axes(const NrrdHeader& header) {
    Axes axes;
    axes.sizes = integers(required(header.fields, "sizes"), "sizes");
    const auto dimension = integer(required(header.fields, "dimension"), "dimension");
    if (dimension < 2 || dimension > 16 || axes.sizes.size() != std::size_t(dimension))
        refuse(fmt::format("states dimension {} and {} sizes; volumes have 3", dimension, axes.sizes.size()));
    axes.first = has_list_first(header, axes.sizes.size()) ? 1 : 0;
    axes.spatial = std::min<std::size_t>(3, axes.sizes.size() - axes.first);
    if (axes.spatial < 2) refuse("has fewer than two axes in space");
    for (std::size_t i = axes.first + axes.spatial; i < axes.sizes.size(); ++i)
        if (axes.sizes[i] < 1 || __builtin_mul_overflow(axes.volumes, std::uint64_t(axes.sizes[i]), &axes.volumes))
            refuse(fmt::format("states a size of {} along axis {}", axes.sizes[i], i));
    return axes;
}

void set_shape(const Axes& axes, Volume& volume) {
    std::array<std::int64_t, 3> n{1, 1, 1};
    std::copy_n(axes.sizes.begin() + std::ptrdiff_t(axes.first), axes.spatial, n.begin());
    const std::int64_t components = axes.first == 1 ? axes.sizes[0] : 1;
    checked_bytes(n, components, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    volume.components = int(components);
    if (axes.spatial == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
    if (axes.volumes > 1) volume.notes.push_back(fmt::format("holds {} volumes; the first is taken", axes.volumes));
}

/// The sign of each world axis that leads from the file's space to ours, and the name of ours.
struct Space {
    World world = World::unknown;
    Vec3 sign{1, 1, 1};
};

Space space_from(const Fields& fields, Volume& volume) {
    std::string name = lower(value_or(fields, "space"));
    if (name.ends_with("-time")) name.resize(name.size() - 5);
    if (name == "left-posterior-superior" || name == "lps" || name == "lpst") return {World::lps};
    if (name == "right-anterior-superior" || name == "ras" || name == "rast") return {World::ras};
    if (name == "left-anterior-superior" || name == "las" || name == "last") {
        volume.notes.push_back("the file's space is left-anterior-superior; given as LPS");
        return {World::lps, {1, -1, 1}};
    }
    if (!name.empty()) volume.notes.push_back("the file's space '" + name + "' says nothing of anatomy");
    return {};
}

Vec3 times(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

void set_directions(const NrrdHeader& header, const Axes& axes, Volume& volume) {
    const Space space = space_from(header.fields, volume);
    const auto vectors = vectors_from(header.fields.at("space directions"), "space directions");
    if (vectors.size() != axes.sizes.size())
        refuse(fmt::format("has {} space directions for {} axes", vectors.size(), axes.sizes.size()));
    std::array<Vec3, 3> steps;
    for (std::size_t i = 0; i < axes.spatial; ++i) {
        const auto& vector = vectors[axes.first + i];
        if (!vector) refuse("has an axis without direction between those in space, which is not supported");
        steps[i] = times(space.sign, *vector);
    }
    if (axes.spatial == 2) steps[2] = normalized(cross(steps[0], steps[1]));
    set_steps(volume.geometry, steps);
    volume.geometry.world = space.world;
    if (const auto origin = vectors_from(value_or(header.fields, "space origin"), "space origin");
        !origin.empty() && origin[0])
        volume.geometry.origin_mm = times(space.sign, *origin[0]);
    else if (space.world != World::unknown)
        volume.notes.push_back("states no space origin; (0, 0, 0) is taken");
}

void set_geometry(const NrrdHeader& header, const Axes& axes, Volume& volume) {
    if (header.fields.contains("space directions")) {
        if (header.fields.contains("spacings"))
            volume.notes.push_back("states spacings beside space directions; the directions are taken");
        return set_directions(header, axes, volume);
    }
    if (header.fields.contains("space"))
        volume.notes.push_back("names a space but no directions in it, so its orientation is unknown");
    if (!header.fields.contains("spacings")) return;
    const auto spacings = numbers(header.fields.at("spacings"), "spacings");
    if (spacings.size() != axes.sizes.size())
        refuse(fmt::format("has {} spacings for {} axes", spacings.size(), axes.sizes.size()));
    for (std::size_t i = 0; i < axes.spatial; ++i) volume.geometry.spacing_mm[int(i)] = spacings[axes.first + i];
}

std::vector<Path> data_files(const NrrdHeader& header, const Path& path) {
    const std::string& field = header.fields.at("data file");
    std::vector<std::string> names{field};
    if (const auto parts = words(field); field.starts_with("LIST"))
        names = header.data_files;
    else if (parts.size() >= 4 && parts[0].find('%') != std::string::npos)
        names = expand_pattern(parts[0], integer(parts[1], "data file"), integer(parts[2], "data file"),
                               integer(parts[3], "data file"));
    std::vector<Path> files;
    for (const auto& name : names) files.push_back(confined(path, name));
    return files;
}

std::uint64_t offset_after_lines(const Path& file, std::uint64_t offset, std::int64_t lines) {
    const auto source = open_plain(file, offset);
    for (std::byte c[1]; lines > 0; ++offset) {
        if (source->read(c) == 0) refuse("ends within the lines to skip");
        if (c[0] == std::byte('\n')) --lines;
    }
    return offset;
}

/// `line skip` counts lines of the file; `byte skip` counts bytes behind them, inflated ones where data are compressed;
/// -1 says that raw data lie at the file's end.
void set_skips(const Fields& fields, std::uint64_t data_bytes, Payload& payload) {
    if (const auto lines = integer(value_or(fields, "line skip", "0"), "line skip"); lines > 0)
        payload.offset = offset_after_lines(payload.files.at(0), payload.offset, lines);
    else if (lines < 0)
        refuse(fmt::format("states a line skip of {}, not 0 or more", lines));
    const auto bytes = integer(value_or(fields, "byte skip", "0"), "byte skip");
    if (bytes < -1) refuse(fmt::format("states a byte skip of {}, not -1 or more", bytes));
    if (bytes >= 0) payload.skip = std::uint64_t(bytes);
    if (bytes == -1 && payload.encoding == Encoding::raw) {
        const auto size = regular_file_size(payload.files.at(0));
        payload.offset = size - std::min(size, data_bytes);
    }
}

Payload payload_from(const NrrdHeader& header, const Axes& axes, const Path& path, const Volume& volume) {
    Payload payload;
    const std::string encoding = lower(required(header.fields, "encoding"));
    if (encoding == "gzip" || encoding == "gz")
        payload.encoding = Encoding::deflated;
    else if (encoding == "ascii" || encoding == "text" || encoding == "txt")
        payload.encoding = Encoding::text;
    else if (encoding != "raw")
        refuse("its encoding is '" + encoding + "', not one of raw, gzip, ascii");
    const std::string endian = lower(value_or(header.fields, "endian", "little"));
    if (endian != "little" && endian != "big") refuse("its endian is '" + endian + "', not little or big");
    if (payload.encoding != Encoding::text && size_of(volume.type) > 1 && !header.fields.contains("endian"))
        refuse("has values of several bytes but states no 'endian'");
    payload.big_endian = endian == "big";
    payload.volumes = axes.volumes;
    const bool attached = !header.fields.contains("data file");
    payload.files = attached ? std::vector{path} : data_files(header, path);
    payload.offset = attached ? header.data_offset : 0;
    if (payload.files.empty()) refuse("lists no data files");
    const auto& n = volume.dimensions;
    set_skips(header.fields, checked_bytes({n[0], n[1], n[2]}, volume.components, volume.type) * axes.volumes, payload);
    return payload;
}

}  // namespace

Volume read_nrrd(const Path& path, const std::string&, Output& output) {
    const NrrdHeader header = read_nrrd_header(path);
    const Axes axes = find_axes(header);
    Volume volume;
    volume.format = "NRRD";
    volume.type = nrrd_type(required(header.fields, "type"));
    volume.key_values = header.key_values;
    volume.modality = value_or(header.key_values, "modality");
    set_shape(axes, volume);
    set_geometry(header, axes, volume);
    read_voxels(payload_from(header, axes, path, volume), volume, output);
    return volume;
}

}  // namespace chiaro::decode
