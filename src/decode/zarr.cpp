// OME-Zarr and Zarr: chunks, in files of their own or in shards.
#include "core/crc32c.h"
#include "decode/limits.h"
#include "decode/payload.h"
#include "decode/readers.h"
#include "decode/zarr_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

namespace chiaro::decode {
namespace {

using Place = std::vector<std::int64_t>;

constexpr std::uint64_t most_in_shard = 1 << 22;      // chunks
constexpr std::uint64_t nothing = ~std::uint64_t(0);  // offset and size, in a shard's index, of a chunk not written

float float_of_half(std::uint16_t half) {
    const int exponent = half >> 10 & 31, fraction = half & 1023;
    const float sign = half & 0x8000 ? -1.F : 1.F;
    if (exponent == 31) return fraction ? std::nanf("") : sign * HUGE_VALF;
    if (exponent == 0) return sign * std::ldexp(float(fraction), -24);
    return sign * std::ldexp(float(fraction + 1024), exponent - 25);
}

/// Offset and size of each chunk in a shard, by its number there.
using ShardIndex = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

/// The index of the shard in this file; none where there is no such file.
std::optional<ShardIndex> shard_index(const ZarrArray& array, const ZarrStore& store, const std::string& name) {
    const ZarrShards& shards = *array.shards;
    std::uint64_t count = 1;
    for (const std::int64_t n : shards.chunks)
        if (__builtin_mul_overflow(count, std::uint64_t(n), &count) || count > most_in_shard)
            refuse(fmt::format("has shards of more than {} chunks", most_in_shard));
    const std::uint64_t bytes = 16 * count + (shards.index_has_checksum ? 4 : 0);
    std::vector<std::byte> packed;
    const auto part = shards.index_is_first ? FilePart::range(0, bytes) : FilePart::last(bytes);
    const auto size = store.read(name, part, packed);
    if (!size) return {};
    if (packed.size() < bytes) refuse(fmt::format("has a shard of {} bytes, less than its index takes", *size));
    if (shards.index_has_checksum &&
        crc32c(std::span(packed).first(bytes - 4)) != number_at(packed.data() + bytes - 4, 4))
        refuse("has a shard whose index has a wrong checksum");
    if (shards.index_is_big_endian) swap_bytes(std::span(packed).first(16 * count), 8);
    ShardIndex index(count);
    for (std::size_t i = 0; i < count; ++i)
        index[i] = {number_at(packed.data() + 16 * i, 8), number_at(packed.data() + 16 * i + 8, 8)};
    return index;
}

class ZarrFile final : public ChunkedFile {
public:
    ZarrFile(const std::string& path, const std::string& part, Output& output)
        : store_(wire::is_url(path) ? open_zarr_on_server(output) : open_zarr_folder(path)),
          image_(open_zarr_image(*store_, part, output)) {
        header_ = std::move(image_.header);
        std::uint64_t largest = 0;
        for (std::size_t i = 0; i < image_.levels.size(); ++i) {
            const ZarrArray& array = image_.levels[i];
            ChunkedLevel level{{1, 1, 1}, {1, 1, 1}, image_.geometries[i]};
            for (std::size_t a = 0; a < 3; ++a)
                if (const int axis = image_.space[a]; axis >= 0) {
                    level.dimensions[a] = int(array.shape[std::size_t(axis)]);
                    level.chunk[a] = int(array.chunk[std::size_t(axis)]);
                }
            levels_.push_back(level);
            largest = std::max(largest, array.chunk_bytes());
        }
        limit_own_memory((std::uint64_t(96) << 20) + 4 * largest_packed(largest));
        if (!is_any_there()) refuse(fmt::format("holds no chunk at '{}'", image_.levels[0].path));
    }

    bool read(int level, const std::array<int, 3>& chunk, int component, std::span<std::byte> to) override {
        const ZarrArray& array = image_.levels[std::size_t(level)];
        Place place(array.shape.size(), 0), in_chunk(array.shape.size(), 0);
        for (std::size_t a = 0; a < 3; ++a)
            if (image_.space[a] >= 0) place[std::size_t(image_.space[a])] = chunk[a];
        const auto take = [&](int axis, int number) {
            if (axis < 0) return;
            place[std::size_t(axis)] = number / array.chunk[std::size_t(axis)];
            in_chunk[std::size_t(axis)] = number % array.chunk[std::size_t(axis)];
        };
        take(image_.time, header_.moments.shown);
        take(image_.channel, image_.first_channel + component);
        if (level != decoded_level_ || place != decoded_place_) {
            decoded_level_ = -1;
            is_written_ = decode(array, level, place);
            decoded_level_ = level, decoded_place_ = place;
        }
        if (is_written_)
            extract(array, in_chunk, to);
        else
            for (std::size_t i = 0; i < to.size(); i += array.fill.size())
                std::ranges::copy(array.fill, to.begin() + std::ptrdiff_t(i));
        return is_written_;
    }

private:
    /// Anything but metadata: a store without a single chunk is one that was cut, or is named otherwise.
    bool is_any_there() const {
        const ZarrArray& array = image_.levels[0];
        if (!store_->lists_names()) return true;
        for (const std::string& name : store_->names(array.path))
            if (name != "zarr.json") return true;
        return false;
    }

    /// The chunk's values as they are stored; false where it was never written.
    bool decode(const ZarrArray& array, int level, const Place& place) {
        Place file_place = place;
        if (array.shards)
            for (std::size_t axis = 0; axis < place.size(); ++axis) file_place[axis] /= array.shards->chunks[axis];
        const std::string name = array.file_of(file_place);
        raw_.resize(array.chunk_bytes());
        const std::uint64_t most = 2 * largest_packed(raw_.size());
        try {
            FilePart part = FilePart::all(most);
            if (array.shards) {
                const auto [offset, bytes] = place_in_shard(array, level, place, file_place, name);
                if (offset == nothing && bytes == nothing) return false;
                if (bytes > most) refuse(fmt::format("has a chunk of {} bytes where at most {} can be", bytes, most));
                part = FilePart::range(offset, bytes);
            }
            packed_.clear();
            if (!(array.shards && part.bytes == 0) && !store_->read(name, part, packed_)) return false;
            unpack(array.codecs, packed_, raw_, spare_);
        } catch (const Error& error) {
            refuse(fmt::format("{} ('{}')", error.what(), name));
        }
        if (array.is_big_endian && array.stored_bytes() > 1) swap_bytes(raw_, array.stored_bytes());
        return true;
    }

    std::pair<std::uint64_t, std::uint64_t> place_in_shard(const ZarrArray& array, int level, const Place& place,
                                                           const Place& shard, const std::string& name) {
        constexpr std::size_t max_kept = 64;
        const std::pair key(level, shard);
        auto found = indices_.find(key);
        if (found == indices_.end()) {
            auto index = shard_index(array, *store_, name);
            if (!index) return {nothing, nothing};
            if (indices_.size() >= max_kept) indices_.clear();
            found = indices_.emplace(key, std::move(*index)).first;
        }
        std::size_t number = 0;
        for (std::size_t axis = 0; axis < place.size(); ++axis)
            number = number * std::size_t(array.shards->chunks[axis]) +
                     std::size_t(place[axis] % array.shards->chunks[axis]);
        return found->second[number];
    }

    /// A box of three axes, x fastest, out of all that a chunk holds.
    void extract(const ZarrArray& array, const Place& in_chunk, std::span<std::byte> to) const {
        std::vector<std::size_t> stride(array.shape.size(), 1);
        std::size_t step = 1, first = 0;
        for (std::size_t i = array.order.size(); i-- > 0; step *= std::size_t(array.chunk[array.order[i]]))
            stride[array.order[i]] = step;
        for (std::size_t axis = 0; axis < stride.size(); ++axis) first += stride[axis] * std::size_t(in_chunk[axis]);
        std::array<std::size_t, 3> along{0, 0, 0}, size{1, 1, 1};
        for (std::size_t a = 0; a < 3; ++a)
            if (const int axis = image_.space[a]; axis >= 0) {
                along[a] = stride[std::size_t(axis)];
                size[a] = std::size_t(array.chunk[std::size_t(axis)]);
            }
        const auto copy = [&]<class T, class Convert>(const T* from, auto* out, const Convert& convert) {
            for (std::size_t z = 0; z < size[2]; ++z)
                for (std::size_t y = 0; y < size[1]; ++y) {
                    const T* row = from + first + z * along[2] + y * along[1];
                    for (std::size_t x = 0; x < size[0]; ++x, row += along[0]) *out++ = convert(*row);
                }
        };
        if (array.is_half)
            return copy(reinterpret_cast<const std::uint16_t*>(raw_.data()), reinterpret_cast<float*>(to.data()),
                        float_of_half);
        with_voxel_type(array.type, [&](auto zero) {
            using T = decltype(zero);
            copy(reinterpret_cast<const T*>(raw_.data()), reinterpret_cast<T*>(to.data()), [](T v) { return v; });
        });
    }

    std::unique_ptr<ZarrStore> store_;
    ZarrImage image_;
    std::map<std::pair<int, Place>, ShardIndex> indices_;
    std::vector<std::byte> packed_, spare_, raw_;
    int decoded_level_ = -1;  ///< of what `raw_` holds; -1: nothing
    Place decoded_place_;
    bool is_written_ = false;
};

std::unique_ptr<ChunkedFile> open_zarr(const std::filesystem::path& path, const std::string& part, Output& output) {
    return std::make_unique<ZarrFile>(path.string(), part, output);
}

}  // namespace

Volume read_zarr(const std::filesystem::path& path, const std::string& part, Output& output) {
    ZarrFile file(path.string(), part, output);
    return read_whole(file, output);
}

Reader find_reader(std::string_view format) { return format == "zarr" ? read_zarr : nullptr; }
ChunkedOpener find_chunked_opener(std::string_view format) { return format == "zarr" ? open_zarr : nullptr; }

}  // namespace chiaro::decode
