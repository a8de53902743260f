// One array of a Zarr store, of version 2 or 3: its shape, and how its chunks are named and packed.
#pragma once
#include "decode/output.h"
#include "decode/zarr_codecs.h"
#include "decode/zarr_store.h"

#include <optional>

namespace chiaro::decode {

/// Chunks of chunks in one file, with an index of where each lies.
struct ZarrShards {
    std::vector<std::int64_t> chunks;  ///< of a shard, along each axis
    bool index_is_first = false, index_is_big_endian = false, index_has_checksum = false;
};

struct ZarrArray {
    std::string path;                 ///< of its folder in the store; empty: the store itself
    std::vector<std::int64_t> shape;  ///< of all axes, as they are declared
    std::vector<std::int64_t> chunk;  ///< the least that is decoded: where there are shards, of what is in them
    std::vector<std::string> names;   ///< of the axes, where they are told
    VoxelType type = VoxelType::u8;
    bool is_half = false;  ///< floats of 16 bits in the file, which become 32
    bool is_big_endian = false;
    std::vector<std::size_t> order;  ///< in which the axes are stored, the slowest first
    std::vector<Codec> codecs;       ///< as they were applied
    std::vector<std::byte> fill;     ///< one value
    std::string prefix;              ///< of the names of chunks: "c", or nothing
    char separator = '.';            ///< between their numbers
    std::optional<ZarrShards> shards;

    std::size_t stored_bytes() const { return is_half ? 2 : size_of(type); }
    /// Of one chunk. Throws Error{input} where that is more than can be decoded.
    std::uint64_t chunk_bytes() const;
    /// The file of a chunk or a shard.
    std::string file_of(const std::vector<std::int64_t>& place) const;
};

/// What an element of the hierarchy says of itself, whichever version it is of.
struct ZarrNode {
    bool is_array = false;
    int version = 0;            ///< of Zarr: 2 or 3; 0: there is none
    nlohmann::json metadata;    ///< of an array
    nlohmann::json attributes;  ///< an object
};
ZarrNode zarr_node(const ZarrStore& store, const std::string& path);

/// Throws Error{input} for what is contradictory, or not read, by name.
ZarrArray zarr_array(const ZarrNode& node, const std::string& path);

}  // namespace chiaro::decode
