#include "decode/hdf5_dataset.h"

#include "decode/hdf5_vtk.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

namespace chiaro::decode {
namespace {

std::optional<VoxelType> type_of(hid_t dataset) {
    const Hdf5Id type(H5Dget_type(dataset), H5Tclose);
    const std::size_t size = H5Tget_size(type);
    const auto kind = H5Tget_class(type);
    if (kind == H5T_FLOAT && (size == 2 || size == 4)) return VoxelType::f32;
    if (kind == H5T_FLOAT && size == 8) return VoxelType::f64;
    if (kind != H5T_INTEGER && kind != H5T_ENUM) return {};  // enumerations: truth values as Python writes them
    const Hdf5Id base(kind == H5T_ENUM ? H5Tget_super(type) : H5Tcopy(type), H5Tclose);
    const bool is_signed = H5Tget_sign(base) != H5T_SGN_NONE;
    switch (size) {
        case 1:
            return is_signed ? VoxelType::i8 : VoxelType::u8;
        case 2:
            return is_signed ? VoxelType::i16 : VoxelType::u16;
        case 4:
            return is_signed ? VoxelType::i32 : VoxelType::u32;
        case 8:
            return is_signed ? VoxelType::i64 : VoxelType::u64;
        default:
            return {};
    }
}

bool is_in_space(char letter) { return letter >= 'x' && letter <= 'z'; }

/// Sizes of the axes; empty for what has none.
std::vector<hsize_t> sizes_of(hid_t dataset) {
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank <= 0 || rank > 32) return {};
    std::vector<hsize_t> sizes(std::size_t(rank), 0);
    H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
    return sizes;
}

/// A letter for each axis, as vigra and ilastik name them: {"axes": [{"key": "z"}, ...]}. Empty where they do not, or
/// name any but x, y, z, c and t, one twice, or only one in space.
std::string letters_of(hid_t dataset, std::size_t axes) {
    const auto tags = nlohmann::json::parse(text_attribute(dataset, "axistags"), nullptr, false);
    if (!tags.is_object() || !tags.contains("axes") || !tags["axes"].is_array() || tags["axes"].size() != axes)
        return {};
    std::string letters;
    for (const auto& tag : tags["axes"]) {
        const std::string key = tag.is_object() && tag.contains("key") && tag["key"].is_string()
                                    ? tag["key"].get<std::string>()
                                    : std::string();
        if (key.size() != 1 || std::string_view("xyzct").find(key) == std::string_view::npos ||
            letters.find(key) != std::string::npos)
            return {};
        letters += key;
    }
    return std::ranges::count_if(letters, is_in_space) < 2 ? std::string() : letters;
}

constexpr hsize_t max_channels_of_axis = 8;

/// As the letters have them.
Hdf5Shape with_named_axes(Hdf5Shape shape) {
    for (std::size_t i = 0; i < shape.letters.size(); ++i) {
        if (is_in_space(shape.letters[i])) shape.axes.push_back(i);
        if (shape.letters[i] == 't' && shape.sizes[i] > 1) shape.time = i;
        if (shape.letters[i] == 'c' && shape.sizes[i] > 1) shape.channels = i;
    }
    if (shape.channels && shape.sizes[*shape.channels] > max_channels_of_axis) shape.axes.clear();
    return shape;
}

/// Drops axes of one element, the slowest first, until three are left. Of four the first, or else the last is that of
/// channels, where it has at most eight.
Hdf5Shape with_axes(Hdf5Shape shape) {
    if (!shape.letters.empty()) return with_named_axes(std::move(shape));
    const std::vector<hsize_t>& sizes = shape.sizes;
    std::size_t surplus = sizes.size() > 3 ? sizes.size() - 3 : 0;
    std::vector<std::size_t> axes;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i] == 1 && surplus > 0)
            --surplus;
        else
            axes.push_back(i);
    }
    if (axes.size() == 4 && sizes[axes.front()] <= max_channels_of_axis)
        shape.channels = axes.front(), axes.erase(axes.begin());
    else if (axes.size() == 4 && sizes[axes.back()] <= max_channels_of_axis)
        shape.channels = axes.back(), axes.pop_back();
    shape.axes = std::move(axes);
    return shape;
}

std::string text_of(const std::vector<hsize_t>& sizes) { return fmt::format("{}", fmt::join(sizes, " x ")); }

Hdf5Shape shape_of(hid_t dataset, const std::string& path) {
    const auto type = type_of(dataset);
    if (!type) refuse(fmt::format("has in '{}' values that are no numbers of 8 to 64 bits", path));
    Hdf5Shape shape{.type = *type, .sizes = sizes_of(dataset)};
    shape.letters = letters_of(dataset, shape.sizes.size());
    shape = with_axes(std::move(shape));
    if (shape.axes.size() < 2 || shape.axes.size() > 3)
        refuse(fmt::format("has in '{}' an array of {} elements; volumes have three axes, and at most eight channels",
                           path, shape.sizes.empty() ? "no" : text_of(shape.sizes)));
    return shape;
}

/// The only dataset with three axes, where none is named.
std::string only_volume(hid_t file) {
    std::vector<std::string> volumes;
    const auto all = datasets_in(file);
    for (const auto& path : all) {
        const Hdf5Id dataset(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose);
        const Hdf5Id made(dataset.is_valid() ? H5Dget_create_plist(dataset) : -1, H5Pclose);
        if (!made.is_valid() || H5Pget_layout(made) == H5D_VIRTUAL) continue;  // whose size may lie in other files
        Hdf5Shape shape{.sizes = sizes_of(dataset)};
        shape.letters = letters_of(dataset, shape.sizes.size());
        const std::size_t least = shape.letters.empty() ? 3 : 2;  // of what is named so a picture is one
        if (type_of(dataset) && with_axes(std::move(shape)).axes.size() >= least) volumes.push_back(path);
    }
    if (volumes.size() == 1) return volumes[0];
    const auto& named = volumes.empty() ? all : volumes;
    if (named.empty()) refuse("holds no dataset");
    const std::size_t shown = std::min<std::size_t>(named.size(), 8);
    refuse(fmt::format("holds {} datasets{}; name one as FILE:/PATH: {}{}", named.size(),
                       volumes.empty() ? ", none with three axes" : " that can be volumes",
                       fmt::join(named.begin(), named.begin() + std::ptrdiff_t(shown), ", "),
                       shown < named.size() ? ", ..." : ""));
}

/// Numbers of an attribute; empty where there is none.
std::vector<double> attribute(hid_t dataset, const char* name) {
    if (H5Aexists(dataset, name) <= 0) return {};
    const Hdf5Id stored(H5Aopen(dataset, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Id type(H5Aget_type(stored), H5Tclose), space(H5Aget_space(stored), H5Sclose);
    const auto kind = H5Tget_class(type);
    const auto count = H5Sget_simple_extent_npoints(space);
    if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || count < 1 || count > 32) return {};
    std::vector<double> values(std::size_t(count), 0);
    if (H5Aread(stored, H5T_NATIVE_DOUBLE, values.data()) < 0) return {};
    return values;
}

void set_spacing(hid_t dataset, const Hdf5Shape& shape, Volume& volume) {
    const auto take = [&](const char* name, double mm) {
        const auto stated = attribute(dataset, name);
        if (stated.empty()) return false;
        const bool for_all = stated.size() == shape.sizes.size();
        if (!for_all && stated.size() < shape.axes.size()) return false;
        for (std::size_t i = 0; i < shape.axes.size(); ++i) {  // i = 0 is the slowest kept axis
            const std::size_t at = for_all ? shape.axes[i] : stated.size() - shape.axes.size() + i;
            volume.geometry.spacing_mm[int(shape.axes.size() - 1 - i)] = mm * stated[at];
        }
        return true;
    };
    if (!take("element_size_um", 1e-3) && !take("spacing", 1))
        volume.notes.push_back("states neither element_size_um nor spacing; 1 mm is taken");
}

/// Named axes in another order than z, y, x run along their own of the world.
void set_directions(const Hdf5Shape& shape, Volume& volume) {
    if (shape.letters.empty()) return;
    std::string missing = "zyx";
    for (const std::size_t axis : shape.axes) std::erase(missing, shape.letters[axis]);
    for (std::size_t i = 0; i < 3; ++i) {
        const char letter =
            i < shape.axes.size() ? shape.letters[shape.axes[shape.axes.size() - 1 - i]] : missing.front();
        Vec3& direction = volume.geometry.direction[i];
        direction = {0, 0, 0};
        direction[letter - 'x'] = 1;
    }
}

void set_channels(const Hdf5Shape& shape, Volume& volume) {
    if (!shape.channels) return;
    volume.components = int(shape.sizes[*shape.channels]);
    volume.has_own_colors = shape.is_interleaved() && are_colors_untold(volume);
    if (!shape.letters.empty()) return;
    volume.notes.push_back(fmt::format("its {} axis, of {}, is taken for channels",
                                       shape.is_interleaved() ? "last" : "first", volume.components));
}

}  // namespace

hid_t hdf5_memory_type(VoxelType type) {
    switch (type) {
        case VoxelType::u8:
            return H5T_NATIVE_UINT8;
        case VoxelType::i8:
            return H5T_NATIVE_INT8;
        case VoxelType::u16:
            return H5T_NATIVE_UINT16;
        case VoxelType::i16:
            return H5T_NATIVE_INT16;
        case VoxelType::u32:
            return H5T_NATIVE_UINT32;
        case VoxelType::i32:
            return H5T_NATIVE_INT32;
        case VoxelType::u64:
            return H5T_NATIVE_UINT64;
        case VoxelType::i64:
            return H5T_NATIVE_INT64;
        case VoxelType::f32:
            return H5T_NATIVE_FLOAT;
        default:
            return H5T_NATIVE_DOUBLE;
    }
}

Hdf5Volume open_hdf5_volume(const std::filesystem::path& path, const std::string& part, const Output& output) {
    Hdf5Id file = open_hdf5(path);
    Volume volume;
    const std::optional<VtkHdfImage> image = part.empty() ? vtkhdf_image(file, volume) : std::nullopt;
    const std::string name = image ? image->dataset : part.empty() ? only_volume(file) : part;
    Hdf5Id dataset = open_dataset(file, name);
    Hdf5Shape shape = shape_of(dataset, name);
    if (shape.time) shape.moment = output.choose_moment(shape.sizes[*shape.time], volume);
    volume.format = "HDF5";
    volume.type = shape.type;
    volume.key_values["dataset"] = name;
    std::array<std::int64_t, 3> n{1, 1, 1};
    for (std::size_t i = 0; i < shape.axes.size(); ++i) {
        const hsize_t size = shape.sizes[shape.axes[shape.axes.size() - 1 - i]];
        n[i] = std::int64_t(std::min<hsize_t>(size, std::uint64_t(1) << 62));
    }
    set_channels(shape, volume);
    checked_bytes(n, volume.components, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    if (shape.axes.size() == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
    if (image && n != image->values)
        refuse(fmt::format("has in '{}' {} values, where its WholeExtent has {} x {} x {}", name, text_of(shape.sizes),
                           image->values[2], image->values[1], image->values[0]));
    if (!image) set_spacing(dataset, shape, volume), set_directions(shape, volume);
    return {std::move(file), std::move(dataset), std::move(shape), std::move(volume)};
}

}  // namespace chiaro::decode
