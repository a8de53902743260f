// HDF5: libhdf5 reads the values; which dataset, and what its axes are, is decided here.
//
// The last axis is x, as everywhere where volumes are kept in HDF5. Spacing comes from the attribute `element_size_um`
// (ilastik, Fiji; micrometres) or `spacing` (millimetres), both in the order of the dataset's axes.
#include "decode/byte_source.h"
#include "decode/hdf5_file.h"
#include "decode/hdf5_vtk.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;

/// A dataset that can be a volume.
struct Shape {
    VoxelType type = VoxelType::u8;
    std::vector<hsize_t> sizes;     ///< of all axes, slowest first
    std::vector<std::size_t> axes;  ///< those that are kept: up to three, without others of one element
};

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

hid_t memory_type(VoxelType type) {
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

/// Sizes of the axes; empty for what has none.
std::vector<hsize_t> sizes_of(hid_t dataset) {
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank <= 0 || rank > 32) return {};
    std::vector<hsize_t> sizes(std::size_t(rank), 0);
    H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
    return sizes;
}

/// Drops axes of one element, the slowest first, until three are left.
std::vector<std::size_t> kept_axes(const std::vector<hsize_t>& sizes) {
    std::size_t surplus = sizes.size() > 3 ? sizes.size() - 3 : 0;
    std::vector<std::size_t> axes;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i] == 1 && surplus > 0)
            --surplus;
        else
            axes.push_back(i);
    }
    return axes;
}

std::string text_of(const std::vector<hsize_t>& sizes) { return fmt::format("{}", fmt::join(sizes, " x ")); }

Shape shape_of(hid_t dataset, const std::string& path) {
    const auto type = type_of(dataset);
    if (!type) refuse(fmt::format("has in '{}' values that are no numbers of 8 to 64 bits", path));
    Shape shape{*type, sizes_of(dataset), {}};
    shape.axes = kept_axes(shape.sizes);
    if (shape.axes.size() < 2 || shape.axes.size() > 3)
        refuse(fmt::format("has in '{}' an array of {} elements; volumes have three axes", path,
                           shape.sizes.empty() ? "no" : text_of(shape.sizes)));
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
        if (type_of(dataset) && kept_axes(sizes_of(dataset)).size() == 3) volumes.push_back(path);
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

void set_spacing(hid_t dataset, const Shape& shape, Volume& volume) {
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

/// Which of the filters makes the checksums of chunks; 32: none does.
unsigned checksum_filter(hid_t made) {
    for (int i = 0; i < H5Pget_nfilters(made); ++i) {
        unsigned flags = 0;
        std::size_t values = 0;
        if (H5Pget_filter2(made, unsigned(i), &flags, &values, nullptr, 0, nullptr, nullptr) == H5Z_FILTER_FLETCHER32)
            return unsigned(i);
    }
    return 32;
}

/// A chunk that says of itself that it was stored without the checksum that all others have.
void check_checksum(hid_t dataset, const std::vector<hsize_t>& at, hsize_t bytes, unsigned filter) {
    std::vector<std::byte> stored(bytes);
    std::uint32_t left_out = 0;
    if (H5Dread_chunk(dataset, H5P_DEFAULT, at.data(), &left_out, stored.data()) < 0 || (left_out >> filter & 1) != 0)
        refuse("has a chunk without its checksum: its index is damaged");
}

/// Elements of a chunk along each axis.
std::vector<hsize_t> chunk_of(hid_t made, const Shape& shape) {
    std::vector<hsize_t> chunk(shape.sizes.size(), 1);
    if (H5Pget_layout(made) == H5D_CHUNKED) H5Pget_chunk(made, int(chunk.size()), chunk.data());
    return chunk;
}

/// Goes to the next chunk; false behind the last.
bool next_chunk(std::vector<hsize_t>& at, const std::vector<hsize_t>& chunk, const std::vector<hsize_t>& sizes) {
    for (std::size_t axis = at.size(); axis-- > 0; at[axis] = 0)
        if ((at[axis] += chunk[axis]) < sizes[axis]) return true;
    return false;
}

/// Whether a chunk was written for a place of the array, which is checked then.
bool check_chunk(hid_t dataset, const std::vector<hsize_t>& at, std::uint64_t file_size, unsigned filter) {
    hsize_t bytes = 0;  // an error, where none is there
    if (H5Dget_chunk_storage_size(dataset, at.data(), &bytes) < 0) bytes = 0;
    if (bytes > file_size) refuse("has a chunk that is larger than the file: its index is damaged");
    if (bytes > 0 && filter < 32) check_checksum(dataset, at, bytes, filter);
    return bytes > 0;
}

using Places = std::set<std::vector<hsize_t>>;

/// The places of chunks by the index, but for those outside of the array.
Places places_in_index(hid_t dataset, hid_t space, hsize_t stored, const Shape& shape) {
    Places places;
    std::vector<hsize_t> at(shape.sizes.size());
    for (hsize_t i = 0; i < stored; ++i) {
        if (H5Dget_chunk_info(dataset, space, i, at.data(), nullptr, nullptr, nullptr) < 0)
            refuse("has an index of chunks that is damaged");
        if (std::ranges::equal(at, shape.sizes, std::less())) places.insert(at);
    }
    return places;
}

/// Chunks hold the fill value where none was written, which is told. Those that lie at no place of the array were
/// meant for another one: a bit flipped in the index, which has no checksum of its own, makes voxels vanish. Asked are
/// all places; where only a few chunks are stored those that the index has, for to find one of them takes a walk
/// through the index. Returns those places.
std::optional<Places> check_chunks(hid_t dataset, hid_t made, std::uint64_t file_size, const Shape& shape,
                                   Volume& volume, Output& output) {
    constexpr hsize_t few = 1024;
    const unsigned filter = checksum_filter(made);
    const std::vector<hsize_t> chunk = chunk_of(made, shape);
    std::uint64_t expected = 1, written = 0, asked = 0;
    for (std::size_t axis = 0; axis < chunk.size(); ++axis)
        expected *= (shape.sizes[axis] + chunk[axis] - 1) / chunk[axis];
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    hsize_t stored = 0;
    if (H5Dget_num_chunks(dataset, space, &stored) < 0) refuse("has an index of chunks that is damaged");
    std::optional<Places> places;
    if (stored < few && stored < expected) {
        places = places_in_index(dataset, space, stored, shape);
        for (const auto& at : *places) written += check_chunk(dataset, at, file_size, filter);
    } else {
        std::vector<hsize_t> at(shape.sizes.size(), 0);
        do {
            written += check_chunk(dataset, at, file_size, filter);
            if (++asked % 4096 == 0) output.progress(0);
        } while (next_chunk(at, chunk, shape.sizes));
    }
    if (stored > written)
        refuse(fmt::format("has {} chunks that lie outside of its array: its index is damaged", stored - written));
    if (written < expected)
        volume.notes.push_back(
            fmt::format("{} of {} chunks were never written; they hold the fill value", expected - written, expected));
    return places;
}

/// Returns the places of chunks where few are stored: elsewhere is the fill value.
std::optional<Places> check_stored(hid_t dataset, std::uint64_t file_size, std::uint64_t bytes, const Shape& shape,
                                   Volume& volume, Output& output) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose), type(H5Dget_type(dataset), H5Tclose);
    const std::uint64_t stored = H5Dget_storage_size(dataset);
    if (stored == 0) refuse("has a dataset whose values were never written");
    if (H5Pget_layout(made) == H5D_CHUNKED) return check_chunks(dataset, made, file_size, shape, volume, output);
    check_capacity(bytes / size_of(volume.type) * H5Tget_size(type), stored);
    return {};
}

/// Elements along the slowest kept axis that lie in the same chunks.
hsize_t slab_of(hid_t dataset, const Shape& shape) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose);
    const std::size_t axis = shape.axes.size() == 3 ? shape.axes[0] : 0;
    return std::clamp<hsize_t>(chunk_of(made, shape)[axis], 1, shape.sizes[axis]);
}

/// libhdf5 would go through all chunks, stored or not.
void fill_few(hid_t dataset, const Shape& shape, const Places& places, Volume& volume) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose), space(H5Dget_space(dataset), H5Sclose);
    const hid_t type = memory_type(volume.type);
    const std::size_t size = size_of(volume.type);
    std::vector<std::byte> value(size);
    if (H5Pget_fill_value(made, type, value.data()) < 0) refuse("has a fill value that is damaged");
    if (std::ranges::any_of(value, [](std::byte b) { return b != std::byte(); }))
        for (std::size_t at = 0; at < volume.voxels.size(); at += size)
            std::copy(value.begin(), value.end(), volume.voxels.data() + at);
    const std::vector<hsize_t> chunk = chunk_of(made, shape);
    for (const auto& at : places) {
        std::vector<hsize_t> count(at.size());
        for (std::size_t axis = 0; axis < at.size(); ++axis)
            count[axis] = std::min(chunk[axis], shape.sizes[axis] - at[axis]);
        if (H5Sselect_hyperslab(space, H5S_SELECT_SET, at.data(), nullptr, count.data(), nullptr) < 0 ||
            H5Dread(dataset, type, space, space, H5P_DEFAULT, volume.voxels.data()) < 0)
            refuse("holds values that are damaged or missing");
    }
}

void fill(hid_t dataset, const Shape& shape, Volume& volume, Output& output) {
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    const std::size_t axis = shape.axes.size() == 3 ? shape.axes[0] : 0;
    const hsize_t size = shape.sizes[axis], slab = slab_of(dataset, shape);
    const std::size_t slice_bytes = volume.voxels.size() / size;
    for (hsize_t first = 0; first < size; first += slab) {
        std::vector<hsize_t> start(shape.sizes.size(), 0), count = shape.sizes;
        start[axis] = first;
        count[axis] = std::min(slab, size - first);
        const Hdf5Id memory(H5Screate_simple(int(count.size()), count.data(), nullptr), H5Sclose);
        if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
            H5Dread(dataset, memory_type(volume.type), memory, space, H5P_DEFAULT,
                    volume.voxels.data() + first * slice_bytes) < 0)
            refuse("holds values that are damaged or missing");
        output.progress(double(first) / double(size));
    }
}

}  // namespace

Volume read_hdf5(const Path& path, const std::string& part, Output& output) {
    const Hdf5Id file = open_hdf5(path);
    Volume volume;
    const std::optional<VtkHdfImage> image = part.empty() ? vtkhdf_image(file, volume) : std::nullopt;
    const std::string name = image ? image->dataset : part.empty() ? only_volume(file) : part;
    const Hdf5Id dataset = open_dataset(file, name);
    const Shape shape = shape_of(dataset, name);
    volume.format = "HDF5";
    volume.type = shape.type;
    volume.key_values["dataset"] = name;
    std::array<std::int64_t, 3> n{1, 1, 1};
    for (std::size_t i = 0; i < shape.axes.size(); ++i) {
        const hsize_t size = shape.sizes[shape.axes[shape.axes.size() - 1 - i]];
        n[i] = std::int64_t(std::min<hsize_t>(size, std::uint64_t(1) << 62));
    }
    const auto bytes = checked_bytes(n, 1, volume.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    if (shape.axes.size() == 2) volume.notes.push_back("a picture of two dimensions, taken as one slice");
    if (image && n != image->values)
        refuse(fmt::format("has in '{}' {} values, where its WholeExtent has {} x {} x {}", name, text_of(shape.sizes),
                           image->values[2], image->values[1], image->values[0]));
    if (!image) set_spacing(dataset, shape, volume);
    const auto few = check_stored(dataset, regular_file_size(path), bytes, shape, volume, output);
    output.allocate(volume);
    if (few)
        fill_few(dataset, shape, *few, volume);
    else
        fill(dataset, shape, volume, output);
    return volume;
}

Reader find_reader(std::string_view format) { return format == "hdf5" ? read_hdf5 : nullptr; }

}  // namespace chiaro::decode
