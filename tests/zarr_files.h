// Small Zarr stores, written chunk by chunk.
#pragma once
#include "volume_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <numeric>
#include <utility>

namespace volume_files {

using Sizes = std::vector<std::int64_t>;

/// How an array is stored.
struct ZarrLayout {
    Sizes shape, chunk;  ///< the slowest axis first
    int version = 2;
    std::string codec = {};  ///< "gzip", ...; empty: none
    /// Packs a chunk's bytes; by default what zlib can do.
    std::function<std::string(const std::string& bytes, const std::string& codec, int value_bytes)> pack = {};
    bool is_big_endian = false, has_checksum = false;
    Sizes order = {};  ///< of axes, as stored; empty: as declared
    char separator = '.';
    std::string fill = "0";
    Sizes shard = {};  ///< version 3: empty: none
    bool index_is_first = false;
    /// Chunks that are not written, by their place.
    std::function<bool(const Sizes&)> is_missing = [](const Sizes&) { return false; };
};

inline std::uint32_t zarr_checksum(const std::string& bytes) {  // bit by bit
    std::uint32_t sum = ~0u;
    for (const char c : bytes) {
        sum ^= std::uint8_t(c);
        for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0x82f63b78 : 0);
    }
    return ~sum;
}

template <class T>
std::string zarr_type(int version, bool big) {
    const std::string bits = std::to_string(8 * sizeof(T));
    const bool is_float = std::is_floating_point_v<T>, is_signed = std::is_signed_v<T>;
    if (version == 3) return (is_float ? "float" : is_signed ? "int" : "uint") + bits;
    return (sizeof(T) == 1 ? "|"
            : big          ? ">"
                           : "<") +
           std::string(is_float    ? "f"
                       : is_signed ? "i"
                                   : "u") +
           std::to_string(sizeof(T));
}

/// Calls f(place) for all places of a grid, the last axis fastest.
inline void for_each_place(const Sizes& count, const std::function<void(const Sizes&)>& f) {
    Sizes at(count.size(), 0);
    for (;;) {
        f(at);
        std::size_t axis = at.size();
        while (axis-- > 0 && ++at[axis] == count[axis]) at[axis] = 0;
        if (axis == std::size_t(-1)) return;
    }
}

/// A chunk's values in the order in which they are stored; 77 beyond the array's border.
template <class T>
std::string zarr_chunk(const ZarrLayout& layout, const Sizes& place, const std::vector<T>& values) {
    Sizes order = layout.order, count;
    if (order.empty()) order.resize(layout.shape.size()), std::iota(order.begin(), order.end(), 0);
    for (const auto axis : order) count.push_back(layout.chunk[std::size_t(axis)]);
    std::string bytes;
    for_each_place(count, [&](const Sizes& stored) {
        std::int64_t index = 0;
        bool is_inside = true;
        for (std::size_t axis = 0; axis < order.size(); ++axis) {
            const auto in_chunk = stored[std::size_t(std::ranges::find(order, std::int64_t(axis)) - order.begin())];
            const std::int64_t at = place[axis] * layout.chunk[axis] + in_chunk;
            is_inside = is_inside && at < layout.shape[axis];
            index = index * layout.shape[axis] + at;
        }
        bytes += bytes_of(is_inside ? values[std::size_t(index)] : T(77), layout.is_big_endian);
    });
    if (layout.pack)
        bytes = layout.pack(bytes, layout.codec, int(sizeof(T)));
    else if (!layout.codec.empty())
        bytes = deflated(bytes, layout.codec == "zlib" ? 15 : 31);
    if (layout.has_checksum) bytes += bytes_of(zarr_checksum(bytes));
    return bytes;
}

inline std::string zarr_list(const Sizes& sizes) { return fmt::format("[{}]", fmt::join(sizes, ", ")); }

/// What the specifications ask for, or writers write: readers may insist on it.
inline std::string zarr_configuration(const std::string& codec, int version, std::size_t value_bytes) {
    if (codec != "blosc") return codec == "lz4" ? R"("acceleration": 1)" : R"("level": 3)";
    const std::string more = version == 2 ? "" : fmt::format(R"(, "typesize": {})", value_bytes);
    return fmt::format(R"("cname": "zstd", "clevel": 5, "blocksize": 0, "shuffle": {}{})",
                       version == 2 ? "1" : R"("shuffle")", more);
}

template <class T>
std::string zarr_metadata(const ZarrLayout& layout) {
    const std::string& codec = layout.codec;
    const std::string configuration = zarr_configuration(codec, layout.version, sizeof(T));
    if (layout.version == 2)
        return fmt::format(
            R"({{"zarr_format": 2, "shape": {}, "chunks": {}, "dtype": "{}", "compressor": {}, "fill_value": {}, )"
            R"("order": "{}", "filters": null, "dimension_separator": "{}"}})",
            zarr_list(layout.shape), zarr_list(layout.chunk), zarr_type<T>(2, layout.is_big_endian),
            codec.empty() ? "null" : fmt::format(R"({{"id": "{}", {}}})", codec, configuration), layout.fill,
            layout.order.empty() ? "C" : "F", layout.separator);
    std::string codecs;
    if (!layout.order.empty())
        codecs +=
            fmt::format(R"({{"name": "transpose", "configuration": {{"order": {}}}}}, )", zarr_list(layout.order));
    codecs += fmt::format(R"({{"name": "bytes", "configuration": {{"endian": "{}"}}}})",
                          layout.is_big_endian ? "big" : "little");
    if (!codec.empty())
        codecs += fmt::format(R"(, {{"name": "{}", "configuration": {{{}{}}}}})", codec, configuration,
                              codec == "zstd" ? R"(, "checksum": false)" : "");
    if (layout.has_checksum) codecs += R"(, {"name": "crc32c"})";
    if (!layout.shard.empty())
        codecs = fmt::format(
            R"({{"name": "sharding_indexed", "configuration": {{"chunk_shape": {}, "codecs": [{}], )"
            R"("index_codecs": [{{"name": "bytes", "configuration": {{"endian": "little"}}}}, {{"name": "crc32c"}}], )"
            R"("index_location": "{}"}}}})",
            zarr_list(layout.chunk), codecs, layout.index_is_first ? "start" : "end");
    return fmt::format(
        R"({{"zarr_format": 3, "node_type": "array", "shape": {}, "data_type": "{}", "chunk_grid": )"
        R"({{"name": "regular", "configuration": {{"chunk_shape": {}}}}}, "chunk_key_encoding": {{"name": "{}", )"
        R"("configuration": {{"separator": "{}"}}}}, "fill_value": {}, "codecs": [{}]}})",
        zarr_list(layout.shape), zarr_type<T>(3, false), zarr_list(layout.shard.empty() ? layout.chunk : layout.shard),
        layout.separator == '/' ? "default" : "v2", layout.separator, layout.fill, codecs);
}

/// A shard: chunks one behind the other, and the index of those that are there.
template <class T>
std::string zarr_shard(const ZarrLayout& layout, const Sizes& shard, const Sizes& inner, const std::vector<T>& values) {
    std::uint64_t count = 1;
    for (const auto n : inner) count *= std::uint64_t(n);
    const std::uint64_t offset = layout.index_is_first ? 16 * count + 4 : 0;
    std::string chunks, index;
    for_each_place(inner, [&](const Sizes& at) {
        Sizes place = at;
        bool is_inside = true;
        for (std::size_t axis = 0; axis < place.size(); ++axis) {
            place[axis] += shard[axis] * inner[axis];
            is_inside = is_inside && place[axis] * layout.chunk[axis] < layout.shape[axis];
        }
        if (!is_inside || layout.is_missing(place)) {
            index += bytes_of(~std::uint64_t(0)) + bytes_of(~std::uint64_t(0));
            return;
        }
        const std::string chunk = zarr_chunk(layout, place, values);
        index += bytes_of(std::uint64_t(offset + chunks.size())) + bytes_of(std::uint64_t(chunk.size()));
        chunks += chunk;
    });
    index += bytes_of(zarr_checksum(index));
    return layout.index_is_first ? index + chunks : chunks + index;
}

/// Files by their name below the array's folder.
template <class T>
std::vector<std::pair<std::string, std::string>> zarr_files(const ZarrLayout& layout, const std::vector<T>& values) {
    std::vector<std::pair<std::string, std::string>> files{
        {layout.version == 2 ? ".zarray" : "zarr.json", zarr_metadata<T>(layout)}};
    const Sizes& unit = layout.shard.empty() ? layout.chunk : layout.shard;
    Sizes count, inner;
    for (std::size_t axis = 0; axis < unit.size(); ++axis) {
        count.push_back((layout.shape[axis] - 1) / unit[axis] + 1);
        inner.push_back(unit[axis] / layout.chunk[axis]);
    }
    for_each_place(count, [&](const Sizes& at) {
        const std::string numbers = fmt::format("{}", fmt::join(at, std::string(1, layout.separator)));
        const std::string name = layout.version == 3 && layout.separator == '/' ? "c/" + numbers : numbers;
        if (!layout.shard.empty())
            files.emplace_back(name, zarr_shard(layout, at, inner, values));
        else if (!layout.is_missing(at))
            files.emplace_back(name, zarr_chunk(layout, at, values));
    });
    return files;
}

template <class T>
void write_zarr(const Folder& folder, const std::string& path, const ZarrLayout& layout, const std::vector<T>& values) {
    for (const auto& [name, bytes] : zarr_files(layout, values)) folder.write(path + "/" + name, bytes);
}

}  // namespace volume_files
