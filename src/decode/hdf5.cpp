// HDF5: libhdf5 reads the values; whether they can be trusted is decided here.
#include "decode/byte_source.h"
#include "decode/hdf5_dataset.h"
#include "decode/limits.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <span>

namespace chiaro::decode {
namespace {

constexpr unsigned no_filter = 32;

/// Which of the filters makes the checksums of chunks; `no_filter`: none does.
unsigned checksum_filter(hid_t made) {
    for (int i = 0; i < H5Pget_nfilters(made); ++i) {
        unsigned flags = 0;
        std::size_t values = 0;
        if (H5Pget_filter2(made, unsigned(i), &flags, &values, nullptr, 0, nullptr, nullptr) == H5Z_FILTER_FLETCHER32)
            return unsigned(i);
    }
    return no_filter;
}

/// A chunk that says of itself that it was stored without the checksum that all others have.
void check_checksum(hid_t dataset, const std::vector<hsize_t>& at, hsize_t bytes, unsigned filter) {
    std::vector<std::byte> stored(bytes);
    std::uint32_t left_out = 0;
    if (H5Dread_chunk(dataset, H5P_DEFAULT, at.data(), &left_out, stored.data()) < 0 || (left_out >> filter & 1) != 0)
        refuse("has a chunk without its checksum: its index is damaged");
}

/// Elements of a chunk along each axis.
std::vector<hsize_t> chunk_of(hid_t made, const Hdf5Shape& shape) {
    std::vector<hsize_t> chunk(shape.sizes.size(), 1);
    if (H5Pget_layout(made) == H5D_CHUNKED) H5Pget_chunk(made, int(chunk.size()), chunk.data());
    return chunk;
}

/// Goes to the next chunk of those from `first` on; false behind the last.
bool next_chunk(std::vector<hsize_t>& at, const std::vector<hsize_t>& first, const std::vector<hsize_t>& chunk,
                const std::vector<hsize_t>& end) {
    for (std::size_t axis = at.size(); axis-- > 0; at[axis] = first[axis])
        if ((at[axis] += chunk[axis]) < end[axis]) return true;
    return false;
}

/// Whether a chunk was written for a place of the array, which is checked then, its checksum where `filter` makes them.
bool check_chunk(hid_t dataset, const std::vector<hsize_t>& at, std::uint64_t file_size, unsigned filter) {
    hsize_t bytes = 0;  // an error, where none is there
    if (H5Dget_chunk_storage_size(dataset, at.data(), &bytes) < 0) bytes = 0;
    if (bytes > file_size) refuse("has a chunk that is larger than the file: its index is damaged");
    if (bytes > 0 && filter < no_filter) check_checksum(dataset, at, bytes, filter);
    return bytes > 0;
}

using Places = std::set<std::vector<hsize_t>>;

/// The places of chunks by the index, but for those outside of the array.
Places places_in_index(hid_t dataset, hid_t space, hsize_t stored, const Hdf5Shape& shape) {
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
std::optional<Places> check_chunks(hid_t dataset, hid_t made, std::uint64_t file_size, unsigned filter,
                                   const Hdf5Shape& shape, Volume& volume, Output& output) {
    constexpr hsize_t few = 1024;
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
        const std::vector<hsize_t> first(shape.sizes.size(), 0);
        std::vector<hsize_t> at = first;
        do {
            written += check_chunk(dataset, at, file_size, filter);
            if (++asked % 4096 == 0) output.progress(0);
        } while (next_chunk(at, first, chunk, shape.sizes));
    }
    if (stored > written)
        refuse(fmt::format("has {} chunks that lie outside of its array: its index is damaged", stored - written));
    if (written < expected)
        volume.notes.push_back(
            fmt::format("{} of {} chunks were never written; they hold the fill value", expected - written, expected));
    return places;
}

/// Returns the places of chunks where few are stored: elsewhere is the fill value. To look for their checksums is to
/// read all of them.
std::optional<Places> check_stored(hid_t dataset, std::uint64_t file_size, bool with_checksums, const Hdf5Shape& shape,
                                   Volume& volume, Output& output) {
    const std::uint64_t bytes = check_header(volume);
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose), type(H5Dget_type(dataset), H5Tclose);
    const std::uint64_t stored = H5Dget_storage_size(dataset);
    if (stored == 0) refuse("has a dataset whose values were never written");
    if (H5Pget_layout(made) == H5D_CHUNKED)
        return check_chunks(dataset, made, file_size, with_checksums ? checksum_filter(made) : no_filter, shape, volume,
                            output);
    check_capacity(bytes / size_of(volume.type) * H5Tget_size(type), stored);
    return {};
}

/// Elements along the slowest kept axis that lie in the same chunks.
hsize_t slab_of(hid_t dataset, const Hdf5Shape& shape) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose);
    const std::size_t axis = shape.axes[0];
    return std::clamp<hsize_t>(chunk_of(made, shape)[axis], 1, shape.sizes[axis]);
}

/// libhdf5 would go through all chunks, stored or not.
void fill_few(hid_t dataset, const Hdf5Shape& shape, const Places& places, Volume& volume) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose), space(H5Dget_space(dataset), H5Sclose);
    const hid_t type = hdf5_memory_type(volume.type);
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

/// Slabs of the whole array, or of one of the channels before it, which then go between the others.
void fill(hid_t dataset, const Hdf5Shape& shape, std::optional<hsize_t> channel, Volume& volume, Output& output) {
    const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
    const std::size_t axis = shape.axes[0];
    const hsize_t size = shape.sizes[axis], slab = slab_of(dataset, shape);
    const std::size_t slice_bytes = volume.voxels.size() / size, value = size_of(volume.type);
    std::vector<std::byte> plane(channel ? slice_bytes / std::size_t(volume.components) * slab : 0);
    for (hsize_t first = 0; first < size; first += slab) {
        std::vector<hsize_t> start(shape.sizes.size(), 0), count = shape.sizes;
        start[axis] = first;
        count[axis] = std::min(slab, size - first);
        if (channel) start[*shape.channels] = *channel, count[*shape.channels] = 1;
        if (shape.time) start[*shape.time] = shape.moment, count[*shape.time] = 1;
        const Hdf5Id memory(H5Screate_simple(int(count.size()), count.data(), nullptr), H5Sclose);
        std::byte* const to = volume.voxels.data() + first * slice_bytes;
        if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
            H5Dread(dataset, hdf5_memory_type(volume.type), memory, space, H5P_DEFAULT, channel ? plane.data() : to) <
                0)
            refuse("holds values that are damaged or missing");
        const std::size_t values = channel ? count[axis] * slice_bytes / std::size_t(volume.components) / value : 0;
        for (std::size_t i = 0; i < values; ++i)
            std::copy_n(plane.data() + i * value, value,
                        to + (i * std::size_t(volume.components) + std::size_t(*channel)) * value);
        const double done = double(channel.value_or(0)) + double(first) / double(size);
        output.progress(channel ? done / volume.components : done);
    }
}

/// A dataset by its chunks, or where it has none by boxes.
class Hdf5Chunks final : public ChunkedFile {
public:
    Hdf5Chunks(Hdf5Volume volume, std::uint64_t file_size, Output& output)
        : file_(std::move(volume.file)),
          dataset_(std::move(volume.dataset)),
          shape_(std::move(volume.shape)),
          file_size_(file_size) {
        header_ = std::move(volume.header);
        check_stored(dataset_, file_size, false, shape_, header_, output);
        const Hdf5Id made(H5Dget_create_plist(dataset_), H5Pclose);
        ChunkedLevel level{header_.dimensions, {64, 64, 64}, header_.geometry};
        std::uint64_t bytes = level.chunk_voxels() * size_of(header_.type);
        if (H5Pget_layout(made) == H5D_CHUNKED) {
            filter_ = checksum_filter(made);
            chunk_ = chunk_of(made, shape_);
            bytes = size_of(header_.type);
            for (const hsize_t edge : chunk_)
                if (__builtin_mul_overflow(bytes, edge, &bytes) || bytes > largest_chunk_bytes)
                    refuse(fmt::format("has chunks of more than {} MiB", largest_chunk_bytes >> 20));
            level.chunk = several_chunks();
        }
        limit_own_memory((std::uint64_t(96) << 20) + 4 * bytes);
        levels_ = {level};
    }

    bool read(int, const std::array<int, 3>& chunk, int component, std::span<std::byte> to) override {
        const ChunkedLevel& level = levels_[0];
        const std::size_t rank = shape_.sizes.size();
        constexpr std::size_t most = 32;  // axes, of any dataset
        std::array<hsize_t, most> corner{}, start{}, count{}, pitch{};
        count.fill(1), pitch.fill(1);
        for (std::size_t i = 0; i < shape_.axes.size(); ++i) {
            const std::size_t axis = shape_.axes[shape_.axes.size() - 1 - i];
            pitch[axis] = hsize_t(level.chunk[i]);
            start[axis] = hsize_t(chunk[i]) * pitch[axis];
            count[axis] = std::min(pitch[axis], shape_.sizes[axis] - start[axis]);
        }
        if (shape_.channels) start[*shape_.channels] = hsize_t(component);
        if (shape_.time) start[*shape_.time] = shape_.moment;
        const bool is_written = is_there(std::span(start).first(rank), std::span(count).first(rank));
        const Hdf5Id space(H5Dget_space(dataset_), H5Sclose),
            memory(H5Screate_simple(int(rank), pitch.data(), nullptr), H5Sclose);
        if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
            H5Sselect_hyperslab(memory, H5S_SELECT_SET, corner.data(), nullptr, count.data(), nullptr) < 0 ||
            H5Dread(dataset_, hdf5_memory_type(header_.type), memory, space, H5P_DEFAULT, to.data()) < 0)
            refuse("holds values that are damaged or missing");
        return is_written;
    }

private:
    /// What is decoded at a time: a chunk, or of small ones some, where coarse levels of it need them all as well.
    std::array<int, 3> several_chunks() const {
        constexpr int thinnest = 8;
        constexpr std::uint64_t most = 1 << 18;  // bytes
        std::array<int, 3> size{1, 1, 1};
        std::uint64_t bytes = size_of(header_.type);
        for (std::size_t i = 0; i < shape_.axes.size(); ++i) {
            size[i] = int(chunk_[shape_.axes[shape_.axes.size() - 1 - i]]);
            bytes *= std::uint64_t(size[i]);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const int grown = grown_edge(size[i], header_.dimensions[i]);
            const std::uint64_t then = bytes / std::uint64_t(size[i]) * std::uint64_t(grown);
            if (size[i] >= thinnest && then <= most) size[i] = grown, bytes = then;
        }
        return size;
    }

    /// Whether any chunk of these elements was written, each of which is checked.
    bool is_there(std::span<const hsize_t> start, std::span<const hsize_t> count) const {
        if (chunk_.empty()) return true;
        std::vector<hsize_t> first, end;
        for (std::size_t axis = 0; axis < chunk_.size(); ++axis) {
            first.push_back(start[axis] - start[axis] % chunk_[axis]);
            end.push_back(start[axis] + count[axis]);
        }
        bool is_written = false;
        std::vector<hsize_t> at = first;
        do is_written |= check_chunk(dataset_, at, file_size_, filter_);
        while (next_chunk(at, first, chunk_, end));
        return is_written;
    }

    Hdf5Id file_, dataset_;
    Hdf5Shape shape_;
    std::uint64_t file_size_;
    std::vector<hsize_t> chunk_;  ///< elements of one along each axis; empty: there are none
    unsigned filter_ = no_filter;
};

std::unique_ptr<ChunkedFile> open_chunks(const std::filesystem::path& path, const std::string& part, Output& output) {
    return std::make_unique<Hdf5Chunks>(open_hdf5_volume(path, part, output), regular_file_size(path), output);
}

}  // namespace

Volume read_hdf5(const std::filesystem::path& path, const std::string& part, Output& output) {
    Hdf5Volume opened = open_hdf5_volume(path, part, output);
    Volume& volume = opened.header;
    const auto few = check_stored(opened.dataset, regular_file_size(path), true, opened.shape, volume, output);
    output.allocate(volume);
    const bool are_planes = opened.shape.channels && !opened.shape.is_interleaved() && volume.components > 1;
    if (few && !are_planes && !opened.shape.time)
        fill_few(opened.dataset, opened.shape, *few, volume);
    else
        for (hsize_t c = 0; c < hsize_t(are_planes ? volume.components : 1); ++c)
            fill(opened.dataset, opened.shape, are_planes ? std::optional(c) : std::nullopt, volume, output);
    return std::move(volume);
}

Reader find_reader(std::string_view format) { return format == "hdf5" ? read_hdf5 : nullptr; }
ChunkedOpener find_chunked_opener(std::string_view format) { return format == "hdf5" ? open_chunks : nullptr; }

}  // namespace chiaro::decode
