#include "decode/zarr_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace chiaro::decode {
namespace {

using nlohmann::json;

std::vector<std::int64_t> sizes_from(const json& list, const char* what) {
    constexpr std::size_t max_axes = 16;
    std::vector<std::int64_t> sizes;
    if (!list.is_array() || list.empty() || list.size() > max_axes)
        refuse(fmt::format("states a {} that is no list of 1 to {} numbers", what, max_axes));
    for (const json& size : list) {
        if (!size.is_number_integer() || size.get<double>() < 1 || size.get<double>() > 1e15)
            refuse(fmt::format("states a {} with {}, which is no size", what, size.dump()));
        sizes.push_back(size.get<std::int64_t>());
    }
    return sizes;
}

void set_type(ZarrArray& array, const std::string& name, const std::string& stated) {
    static const std::map<std::string, VoxelType> types = {
        {"u1", VoxelType::u8},  {"i1", VoxelType::i8},  {"u2", VoxelType::u16}, {"i2", VoxelType::i16},
        {"u4", VoxelType::u32}, {"i4", VoxelType::i32}, {"u8", VoxelType::u64}, {"i8", VoxelType::i64},
        {"f2", VoxelType::f32}, {"f4", VoxelType::f32}, {"f8", VoxelType::f64}, {"b1", VoxelType::u8}};
    const auto found = types.find(name);
    if (found == types.end()) refuse(fmt::format("holds values of type '{}', which is not read", stated));
    array.type = found->second;
    array.is_half = name == "f2";
}

template <class T>
T value_from(const json& stated) {
    double number = 0;
    if (stated.is_boolean()) return T(stated.get<bool>());
    if (stated.is_string()) {
        const auto text = stated.get<std::string>();
        if (text == "NaN") number = std::numeric_limits<double>::quiet_NaN();
        if (text == "Infinity") number = std::numeric_limits<double>::infinity();
        if (text == "-Infinity") number = -std::numeric_limits<double>::infinity();
        if (number == 0 || std::is_integral_v<T>) refuse(fmt::format("states the fill value '{}'", text));
        return T(number);
    }
    if (!stated.is_number()) refuse(fmt::format("states the fill value {}", stated.dump()));
    if constexpr (std::is_integral_v<T>) {
        using Limits = std::numeric_limits<T>;
        if (stated.is_number_unsigned() && stated.get<std::uint64_t>() <= std::uint64_t(Limits::max()))
            return T(stated.get<std::uint64_t>());
        if (stated.is_number_integer() && !stated.is_number_unsigned() && std::is_signed_v<T> &&
            stated.get<std::int64_t>() >= std::int64_t(Limits::min()))
            return T(stated.get<std::int64_t>());
        number = stated.get<double>();
        if (!stated.is_number_float() || number != std::floor(number) || !(std::abs(number) < 0x1p53) ||
            number < double(Limits::min()) || number > double(Limits::max()))
            refuse(fmt::format("states the fill value {}, which its type cannot hold", stated.dump()));
        return T(number);
    } else {
        return T(stated.get<double>());
    }
}

void set_fill(ZarrArray& array, const json& metadata) {
    const json stated = metadata.value("fill_value", json());
    array.fill.assign(size_of(array.type), std::byte());
    if (stated.is_null()) return;
    with_voxel_type(array.type, [&](auto zero) {
        const auto value = value_from<decltype(zero)>(stated);
        std::memcpy(array.fill.data(), &value, sizeof value);
    });
}

std::vector<std::size_t> in_order(std::size_t axes) {
    std::vector<std::size_t> order(axes);
    std::iota(order.begin(), order.end(), std::size_t(0));
    return order;
}

void set_separator(ZarrArray& array, const std::string& text) {
    if (text != "." && text != "/") refuse(fmt::format("states '{}' between the numbers of a chunk, not . or /", text));
    array.separator = text[0];
}

ZarrArray of_version_2(const json& metadata) {
    ZarrArray array;
    array.shape = sizes_from(metadata.at("shape"), "shape");
    array.chunk = sizes_from(metadata.at("chunks"), "chunk");
    if (!metadata.at("dtype").is_string()) refuse("holds records, not single numbers");
    const auto type = metadata.at("dtype").get<std::string>();
    set_type(array, type.substr(std::min<std::size_t>(1, type.size())), type);
    array.is_big_endian = type[0] == '>';
    array.order = in_order(array.shape.size());
    const auto order = metadata.value("order", std::string("C"));
    if (order == "F")
        std::ranges::reverse(array.order);
    else if (order != "C")
        refuse(fmt::format("states the order '{}', not C or F", order));
    if (const auto filters = metadata.find("filters"); filters != metadata.end() && !filters->empty())
        refuse(fmt::format("uses the filter '{}', which is not read", filters->at(0).at("id").get<std::string>()));
    if (const auto compressor = metadata.find("compressor"); compressor != metadata.end() && !compressor->is_null())
        array.codecs = {codec_named(compressor->at("id").get<std::string>())};
    set_separator(array, metadata.value("dimension_separator", std::string(".")));
    set_fill(array, metadata);
    return array;
}

/// `configuration` of an extension of version 3, which may be left out.
json configured(const json& extension) { return extension.value("configuration", json::object()); }

std::string name_of(const json& extension) {
    return extension.is_string() ? extension.get<std::string>() : extension.at("name").get<std::string>();
}

void transpose(ZarrArray& array, const json& order) {
    auto stated = in_order(array.shape.size());
    if (order == "F") {
        std::ranges::reverse(stated);
    } else if (order != "C") {
        stated = order.get<std::vector<std::size_t>>();
        if (!std::ranges::is_permutation(stated, in_order(array.shape.size())))
            refuse(fmt::format("is transposed by {}, which is no order of its axes", order.dump()));
    }
    std::vector<std::size_t> after;
    for (const std::size_t axis : stated) after.push_back(array.order[axis]);
    array.order = after;
}

void set_endian(bool& is_big_endian, const json& codec) {
    const auto endian = configured(codec).value("endian", std::string("little"));
    if (endian != "little" && endian != "big") refuse(fmt::format("states the byte order '{}'", endian));
    is_big_endian = endian == "big";
}

void set_shards(ZarrArray& array, const json& configuration) {
    ZarrShards shards;
    const auto inner = sizes_from(configuration.at("chunk_shape"), "chunk of a shard");
    if (inner.size() != array.chunk.size()) refuse("states chunks of a shard with another number of axes");
    for (std::size_t axis = 0; axis < inner.size(); ++axis) {
        if (array.chunk[axis] % inner[axis] != 0)
            refuse(fmt::format("states shards of {} voxels, which are no multiple of its chunks' {}", array.chunk[axis],
                               inner[axis]));
        shards.chunks.push_back(array.chunk[axis] / inner[axis]);
    }
    array.chunk = inner;
    const auto place = configuration.value("index_location", std::string("end"));
    if (place != "end" && place != "start") refuse(fmt::format("states its shards' index at the '{}'", place));
    shards.index_is_first = place == "start";
    for (const json& codec : configuration.at("index_codecs")) {
        if (name_of(codec) == "bytes" && !shards.index_has_checksum)
            set_endian(shards.index_is_big_endian, codec);
        else if (name_of(codec) == "crc32c" && !shards.index_has_checksum)
            shards.index_has_checksum = true;
        else
            refuse(fmt::format("packs its shards' index by '{}', which is not read", name_of(codec)));
    }
    array.shards = shards;
}

void set_codecs(ZarrArray& array, const json& codecs) {
    bool is_bytes = false;
    for (const json& codec : codecs) {
        const std::string name = name_of(codec);
        if (name == "sharding_indexed") {
            if (array.shards) refuse("has shards within shards, which are not read");
            if (codecs.size() > 1) refuse("packs or transposes whole shards, which is not read");
            set_shards(array, configured(codec));
            return set_codecs(array, configured(codec).at("codecs"));
        }
        if (name == "transpose" && !is_bytes) {
            transpose(array, configured(codec).at("order"));
        } else if (name == "bytes" && !is_bytes) {
            is_bytes = true;
            set_endian(array.is_big_endian, codec);
        } else if (is_bytes && name != "zlib" && name != "lz4") {
            array.codecs.push_back(codec_named(name));
        } else {
            refuse(fmt::format("uses the codec '{}', which is not read there", name));
        }
    }
    if (!is_bytes) refuse("states no codec that makes bytes of numbers");
}

ZarrArray of_version_3(const json& metadata) {
    static const std::map<std::string, std::string> types = {
        {"uint8", "u1"},  {"int8", "i1"},  {"uint16", "u2"},  {"int16", "i2"},   {"uint32", "u4"},  {"int32", "i4"},
        {"uint64", "u8"}, {"int64", "i8"}, {"float16", "f2"}, {"float32", "f4"}, {"float64", "f8"}, {"bool", "b1"}};
    ZarrArray array;
    array.shape = sizes_from(metadata.at("shape"), "shape");
    if (!metadata.at("data_type").is_string()) refuse("holds values of a type that is not read");
    const auto type = metadata.at("data_type").get<std::string>();
    const auto known = types.find(type);
    set_type(array, known == types.end() ? "" : known->second, type);
    const json& grid = metadata.at("chunk_grid");
    if (name_of(grid) != "regular") refuse(fmt::format("has its chunks in a grid '{}'", name_of(grid)));
    array.chunk = sizes_from(configured(grid).at("chunk_shape"), "chunk");
    array.order = in_order(array.shape.size());
    if (array.chunk.size() == array.shape.size()) set_codecs(array, metadata.at("codecs"));
    const json& keys = metadata.at("chunk_key_encoding");
    const bool is_default = name_of(keys) == "default";
    if (!is_default && name_of(keys) != "v2") refuse(fmt::format("names its chunks by '{}'", name_of(keys)));
    array.prefix = is_default ? "c" : "";
    const json configuration = keys.is_string() ? json::object() : configured(keys);
    set_separator(array, configuration.value("separator", std::string(is_default ? "/" : ".")));
    if (const auto more = metadata.find("storage_transformers"); more != metadata.end() && !more->empty())
        refuse("uses storage transformers, which are not read");
    if (const auto names = metadata.find("dimension_names"); names != metadata.end() && names->is_array())
        for (const json& name : *names) array.names.push_back(name.is_string() ? name.get<std::string>() : "");
    set_fill(array, metadata);
    return array;
}

}  // namespace

std::uint64_t ZarrArray::chunk_bytes() const {
    std::uint64_t bytes = stored_bytes();
    for (const std::int64_t edge : chunk)
        if (__builtin_mul_overflow(bytes, std::uint64_t(edge), &bytes) || bytes > largest_chunk_bytes)
            refuse(fmt::format("has chunks of {} values, more than the {} MiB that are decoded at a time",
                               fmt::join(chunk, " x "), largest_chunk_bytes >> 20));
    return bytes;
}

std::string ZarrArray::file_of(const std::vector<std::int64_t>& place) const {
    std::string name = prefix;
    for (const std::int64_t number : place) {
        if (!name.empty()) name += separator;
        name += std::to_string(number);
    }
    return joined(path, name);
}

ZarrNode zarr_node(const ZarrStore& store, const std::string& path) {
    ZarrNode node{false, 0, {}, json::object()};
    if (auto metadata = store.json(joined(path, "zarr.json"))) {
        node.version = 3;
        node.attributes = metadata->value("attributes", json::object());
        node.is_array = metadata->value("node_type", std::string()) == "array";
        node.metadata = std::move(*metadata);
    } else {
        if (auto array = store.json(joined(path, ".zarray"))) {
            node.is_array = true, node.version = 2;
            node.metadata = std::move(*array);
        }
        if (auto attributes = store.json(joined(path, ".zattrs"))) node.version = 2, node.attributes = *attributes;
        if (node.version == 0 && store.json(joined(path, ".zgroup"))) node.version = 2;
    }
    if (!node.attributes.is_object()) refuse("states attributes that are no JSON object");
    return node;
}

ZarrArray zarr_array(const ZarrNode& node, const std::string& path) {
    ZarrArray array = node.version == 3 ? of_version_3(node.metadata) : of_version_2(node.metadata);
    array.path = path;
    if (array.chunk.size() != array.shape.size()) refuse("states chunks with another number of axes than its array");
    if (const auto names = node.attributes.find("_ARRAY_DIMENSIONS");
        array.names.empty() && names != node.attributes.end() && names->is_array())
        for (const json& name : *names) array.names.push_back(name.is_string() ? name.get<std::string>() : "");
    if (array.names.size() != array.shape.size()) array.names.clear();
    array.chunk_bytes();
    return array;
}

}  // namespace chiaro::decode
