#include "decode/nrrd_header.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
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
        if (parts.size() != 3 && parts.size() != 4)
            refuse(fmt::format("its '{}' has {} numbers in a vector, not 3", what, parts.size()));
        const Vec3 vector{number(parts[0], what), number(parts[1], what), number(parts[2], what)};
        const bool is_time_alone = parts.size() == 4 && vector == Vec3{};  // of spaces such as left-...-superior-time
        result.push_back(is_time_alone ? std::nullopt : std::optional(vector));
        at = end + 1;
    }
    return result;
}

/// Which of the file's axes are what.
struct Axes {
    std::vector<std::int64_t> sizes;
    std::vector<std::size_t> space;   ///< two (one slice) or three
    bool has_list = false;            ///< values of a voxel come first
    std::string kind_of_list;         ///< "rgb-color", "vector"; empty: not told
    std::optional<std::size_t> time;  ///< the one that moments follow each other along
    std::uint64_t volumes = 1;        ///< along all axes but those

    /// How many values there are along the axes before this one.
    std::uint64_t before(std::size_t axis) const {
        std::uint64_t product = 1;
        for (std::size_t i = 0; i < axis; ++i)
            if (__builtin_mul_overflow(product, std::uint64_t(sizes[i]), &product))
                refuse("states more voxels than can be counted in 64 bits");
        return product;
    }
};

/// Sequences of 3D Slicer call their moments a list.
bool has_moments_first(const NrrdHeader& header) {
    return header.key_values.contains("MultiVolume.FrameIdentifyingDICOMTagName") ||
           header.key_values.contains("axis 0 index values");
}

bool has_list_first(const NrrdHeader& header, const std::vector<std::string>& kinds, std::size_t dimension) {
    if (has_moments_first(header) || (!kinds.empty() && kinds[0] == "time")) return false;
    if (const auto directions = value_or(header.fields, "space directions"); !directions.empty())
        return directions.starts_with("none");
    const auto in_space = [](const std::string& kind) {
        return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
    };
    return kinds.size() == dimension && !in_space(kinds[0]);
}

/// Time is an axis that says so, or has no direction in space; else the first behind those in space.
void tell_axes_apart(const NrrdHeader& header, Axes& axes) {
    const std::size_t dimension = axes.sizes.size();
    const auto kinds = words(lower(value_or(header.fields, "kinds")));
    const auto vectors = vectors_from(value_or(header.fields, "space directions"), "space directions");
    axes.has_list = has_list_first(header, kinds, dimension);
    if (axes.has_list && kinds.size() == dimension && kinds[0] != "???" && kinds[0] != "none")
        axes.kind_of_list = kinds[0];
    std::optional<std::size_t> behind;
    for (std::size_t i = axes.has_list ? 1 : 0; i < dimension; ++i) {
        const bool is_time = kinds.size() == dimension && kinds[i] == "time";
        const bool is_undirected = vectors.size() == dimension && !vectors[i];
        const bool is_first = i == 0 && has_moments_first(header);
        if (!axes.time && (is_time || is_first || (is_undirected && axes.space.size() < 3)))
            axes.time = i;
        else if (axes.space.size() < 3 && !is_undirected)
            axes.space.push_back(i);
        else if (axes.space.size() < 3)
            refuse("has an axis without direction between those in space, which is not supported");
        else if (!behind)
            behind = i;
    }
    if (!axes.time) axes.time = behind;
    if (axes.space.size() < 2) refuse("has fewer than two axes in space");
}

Axes find_axes(const NrrdHeader& header) {
    Axes axes;
    axes.sizes = integers(required(header.fields, "sizes"), "sizes");
    const auto dimension = integer(required(header.fields, "dimension"), "dimension");
    if (dimension < 2 || dimension > 16 || axes.sizes.size() != std::size_t(dimension))
        refuse(fmt::format("states dimension {} and {} sizes; volumes have 3", dimension, axes.sizes.size()));
    tell_axes_apart(header, axes);
    for (std::size_t i = axes.has_list ? 1 : 0; i < axes.sizes.size(); ++i)
        if (std::find(axes.space.begin(), axes.space.end(), i) == axes.space.end() &&
            (axes.sizes[i] < 1 || __builtin_mul_overflow(axes.volumes, std::uint64_t(axes.sizes[i]), &axes.volumes)))
            refuse(fmt::format("states a size of {} along axis {}", axes.sizes[i], i));
    return axes;
}

void set_shape(const Axes& axes, Volume& volume) {
    std::array<std::int64_t, 3> n{1, 1, 1};
    for (std::size_t i = 0; i < axes.space.size(); ++i) n[i] = axes.sizes[axes.space[i]];
    const std::int64_t components = axes.has_list ? axes.sizes[0] : 1;
    checked_bytes(n, components, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    volume.components = int(components);
    const bool can_be_colors = components == 3 || components == 4;
    const std::string& kind = axes.kind_of_list;
    volume.has_own_colors = can_be_colors && (kind.ends_with("-color") || (kind.empty() && are_colors_untold(volume)));
    if (axes.space.size() == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
}

/// What a field says of one axis, in the place of quoted or plain words.
std::string word_of_axis(const NrrdHeader& header, const char* field, std::size_t axis) {
    const auto all = words(value_or(header.fields, field));
    std::string word = axis < all.size() ? all[axis] : "";
    std::erase(word, '"');
    return word;
}

void set_times(const NrrdHeader& header, std::size_t axis, Moments& moments) {
    const auto listed = [&](const char* key, const char* separators) {
        std::vector<double> times;
        double time = 0;
        for (const auto& word : words(value_or(header.key_values, key), separators))
            if (std::from_chars(word.data(), word.data() + word.size(), time).ec == std::errc()) times.push_back(time);
        if (times.size() == std::size_t(moments.count)) moments.times = times;
    };
    const std::string step = word_of_axis(header, "spacings", axis);
    if (!step.empty()) set_even_times(moments, 0, number(step, "spacings"), word_of_axis(header, "units", axis));
    if (axis > 0) return;
    listed("MultiVolume.FrameLabels", ",");
    listed("axis 0 index values", " ");
    moments.unit = value_or(header.key_values, "MultiVolume.FrameIdentifyingDICOMTagUnits", moments.unit);
}

MomentAxis moments_of(const NrrdHeader& header, const Axes& axes, Volume& volume, const Output& output) {
    const std::uint64_t moments = axes.time ? std::uint64_t(axes.sizes[*axes.time]) : 1;
    if (axes.volumes > moments)
        volume.notes.push_back(
            fmt::format("holds {} volumes for each moment; the first is taken", axes.volumes / moments));
    MomentAxis axis{.count = moments, .wanted = output.choose_moment(moments, volume)};
    if (axes.time) axis.run = axes.before(*axes.time) * size_of(volume.type);
    if (axes.time) set_times(header, *axes.time, volume.moments);
    return axis;
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
    for (std::size_t i = 0; i < axes.space.size(); ++i) {
        const auto& vector = vectors[axes.space[i]];
        if (!vector) refuse("has an axis without direction between those in space, which is not supported");
        steps[i] = times(space.sign, *vector);
    }
    if (axes.space.size() == 2) steps[2] = normalized(cross(steps[0], steps[1]));
    set_steps(volume.geometry, steps);
    volume.geometry.world = space.world;
    if (const auto origin = value_or(header.fields, "space origin"); origin.starts_with('('))
        volume.geometry.origin_mm = times(space.sign, vectors_from(origin, "space origin")[0].value_or(Vec3{}));
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
    for (std::size_t i = 0; i < axes.space.size(); ++i) volume.geometry.spacing_mm[int(i)] = spacings[axes.space[i]];
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

Payload payload_from(const NrrdHeader& header, const Axes& axes, const MomentAxis& moments, const Path& path,
                     const Volume& volume) {
    Payload payload;
    payload.moments = moments;
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
    const MomentAxis moments = moments_of(header, axes, volume, output);
    read_voxels(payload_from(header, axes, moments, path, volume), volume, output);
    return volume;
}

}  // namespace chiaro::decode
