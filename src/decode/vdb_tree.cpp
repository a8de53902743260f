#include "decode/vdb_tree.h"

#include <openvdb/io/Compression.h>
#include <zlib.h>

#include <algorithm>
#include <map>

namespace chiaro::decode {
namespace {

namespace io = openvdb::io;

VdbPlace moved(const VdbPlace& place, int x, int y, int z) { return {place[0] + x, place[1] + y, place[2] + z}; }

VdbPlace last_of(const VdbPlace& origin, int edge) { return moved(origin, edge - 1, edge - 1, edge - 1); }

/// Where an entry of a node lies, of 2^log2 along an edge.
template <unsigned log2>
VdbPlace entry_of(const VdbPlace& origin, unsigned entry, int entry_edge) {
    constexpr unsigned mask = (1U << log2) - 1;
    return moved(origin, int(entry >> 2 * log2) * entry_edge, int(entry >> log2 & mask) * entry_edge,
                 int(entry & mask) * entry_edge);
}

/// Along each axis, which voxels of a cube lie in a window: from the first to behind the last.
template <class T>
bool overlap(const VdbPlace& origin, int edge, const VdbWindow<T>& window, VdbPlace& begin, VdbPlace& end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t before = window.first[axis] - origin[axis];
        begin[axis] = int(std::clamp<std::int64_t>(before, 0, edge));
        end[axis] = int(std::clamp<std::int64_t>(before + window.size[axis], 0, edge));
        if (begin[axis] >= end[axis]) return false;
    }
    return true;
}

/// `value(x, y, z)` of a cube of voxels, as far as they lie in the window.
template <class T, class Value>
void put_cube(const VdbPlace& origin, int edge, const VdbWindow<T>& window, const Value& value) {
    VdbPlace begin, end;
    if (!overlap(origin, edge, window, begin, end)) return;
    for (int z = begin[2]; z < end[2]; ++z)
        for (int y = begin[1]; y < end[1]; ++y) {
            const std::int64_t line =
                (origin[2] + z - window.first[2]) * window.size[1] + (origin[1] + y - window.first[1]);
            T* row = window.voxels + line * window.size[0] + (origin[0] - window.first[0]);
            for (int x = begin[0]; x < end[0]; ++x) row[x] = value(x, y, z);
        }
}

/// How many values of their own a node's inactive voxels have, and whether a mask chooses between two, by the library's
/// byte for it.
struct InactiveValues {
    int count;
    bool has_mask;
};
constexpr InactiveValues inactive_values[] = {{0, false}, {0, false}, {1, false}, {0, true},
                                              {1, true},  {2, true},  {0, false}};

}  // namespace

void VdbBox::add(const VdbPlace& origin, const VdbPlace& end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = std::min<std::int64_t>(first[axis], origin[axis]);
        last[axis] = std::max<std::int64_t>(last[axis], end[axis]);
    }
}

template <class T>
VdbTree<T>::VdbTree(VdbStream& stream, std::uint32_t version, const VdbGrid& grid, std::uint32_t compression)
    : stream_(stream), grid_(grid), version_(version), compression_(compression) {
    io::setDataCompression(stream, compression);
    io::setGridBackgroundValuePtr(stream, &background_);
    read_root();
    if (stream.position() != grid.blocks)
        refuse(fmt::format("has a grid '{}' whose tree does not end where its values begin", grid.name));
}

template <class T>
void VdbTree<T>::read_root() {
    if (stream_.number<std::int32_t>() != 1) refuse("holds a tree of several values a voxel, which is not read");
    background_ = stream_.number<T>();
    const auto tiles = stream_.number<std::uint32_t>(), children = stream_.number<std::uint32_t>();
    std::map<VdbPlace, std::vector<Leaf>> nodes;  // the values of leaves lie in the order of the nodes' origins
    const auto next_origin = [&] {
        const auto origin = stream_.number<VdbPlace>();
        if (std::ranges::any_of(origin, [](int at) { return at % root_edge != 0; }) ||
            !nodes.try_emplace(origin).second)
            refuse(fmt::format("has a node at {}, {}, {} where none can be", origin[0], origin[1], origin[2]));
        return origin;
    };
    for (std::uint32_t i = 0; i < tiles; ++i) {
        const VdbPlace origin = next_origin();
        const T value = stream_.number<T>();
        if (stream_.number<std::uint8_t>()) box_.add(origin, last_of(origin, root_edge));
        if (!is_background(value)) tiles_.push_back({origin, 1, root_edge, {value}});
    }
    for (std::uint32_t i = 0; i < children; ++i) {
        const VdbPlace origin = next_origin();
        read_node<5>(origin, nodes.at(origin));
    }
    for (const auto& [origin, leaves] : nodes) leaves_.insert(leaves_.end(), leaves.begin(), leaves.end());
}

template <class T>
template <unsigned log2>
void VdbTree<T>::read_node(const VdbPlace& origin, std::vector<Leaf>& leaves) {
    using Mask = openvdb::util::NodeMask<log2>;
    constexpr int entry_edge = log2 == 5 ? 128 : leaf_edge;
    Mask children, active;
    children.load(stream_), active.load(stream_);
    const bool is_old = version_ < vdb_of_masks;  // which have no values where nodes are
    std::vector<T> values(is_old ? children.countOff() : Mask::SIZE);
    read_values(active, std::span<T>(values));
    std::vector<T> entries(Mask::SIZE, background_);
    bool has_tiles = false;
    for (unsigned i = 0, next = 0; i < Mask::SIZE; ++i) {
        if (children.isOn(i)) continue;
        entries[i] = values[is_old ? next++ : i];
        has_tiles |= !is_background(entries[i]);
        const VdbPlace at = entry_of<log2>(origin, i, entry_edge);
        if (active.isOn(i)) box_.add(at, last_of(at, entry_edge));
    }
    if (has_tiles) tiles_.push_back({origin, 1 << log2, entry_edge, std::move(entries)});
    for (auto child = children.beginOn(); child; ++child) {
        const VdbPlace at = entry_of<log2>(origin, child.pos(), entry_edge);
        if constexpr (log2 == 5) {
            read_node<4>(at, leaves);
        } else {
            LeafMask mask;
            mask.load(stream_);
            for (auto voxel = mask.beginOn(); voxel; ++voxel) {
                const VdbPlace place = entry_of<3>(at, voxel.pos(), 1);
                box_.add(place, place);
            }
            leaves.push_back({at});
        }
    }
}

/// Where those of a node are that begin here; leaves the stream here.
template <class T>
template <class Mask>
VdbBlock VdbTree<T>::values_here(const Mask& mask, std::size_t count) {
    const std::uint64_t here = stream_.position();
    if (version_ >= vdb_of_masks) {
        const auto kind = stream_.number<std::uint8_t>();
        if (kind >= std::size(inactive_values)) refuse(fmt::format("has a node of the unknown kind {}", kind));
        const auto [own_values, has_mask] = inactive_values[kind];
        stream_.skip(std::uint64_t(own_values) * sizeof(T) + (has_mask ? Mask::SIZE / 8 : 0));
        constexpr unsigned all_values = 6;
        if ((compression_ & io::COMPRESS_ACTIVE_MASK) && kind != all_values) count = mask.countOn();
    }
    VdbBlock block{.values = count * (grid_.is_half ? 2 : sizeof(T))};
    std::uint64_t bytes = block.values;
    if ((compression_ & (io::COMPRESS_ZIP | io::COMPRESS_BLOSC)) && !(grid_.is_half && count == 0)) {
        constexpr std::int64_t overhead = 64;
        const auto stored = stream_.number<std::int64_t>(), expected = std::int64_t(bytes);
        if (stored <= 0 ? stored != -expected : stored > expected + overhead)
            refuse(fmt::format("has a node of {} bytes where {} are expected", stored, expected));
        block.is_packed = stored > 0;
        if (block.is_packed) bytes = std::uint64_t(stored);
    }
    block.begin = stream_.position();
    block.end = block.begin + bytes;
    if (block.is_packed && (compression_ & io::COMPRESS_BLOSC)) {
        const auto header = stream_.number<std::array<std::uint32_t, 4>>();
        if (bytes < sizeof header || header[1] != block.values || header[3] != bytes)
            refuse("has a node whose compressed values state another size");
    }
    stream_.go_to(block.end);  // which is there
    stream_.go_to(here);
    return block;
}

/// The library does not look at checksums.
template <class T>
void VdbTree<T>::check_zlib(const VdbBlock& block) {
    const std::uint64_t here = stream_.position();
    std::vector<Bytef> packed(block.end - block.begin), values(block.values);
    stream_.go_to(block.begin);
    stream_.read(reinterpret_cast<char*>(packed.data()), std::streamsize(packed.size()));
    uLongf size = values.size();
    if (uncompress(values.data(), &size, packed.data(), packed.size()) != Z_OK || size != values.size())
        refuse("has a node whose compressed values are damaged");
    stream_.go_to(here);
}

template <class T>
template <class Mask>
void VdbTree<T>::read_values(const Mask& mask, std::span<T> to) {
    const VdbBlock block = values_here(mask, to.size());
    if (block.is_packed && !(compression_ & io::COMPRESS_BLOSC)) check_zlib(block);
    by_library("values",
               [&] { io::readCompressedValues(stream_, to.data(), openvdb::Index(to.size()), mask, grid_.is_half); });
    if (stream_.position() != block.end) refuse("has a node whose values do not end where they should");
}

/// What stands before a leaf's values.
template <class T>
void VdbTree<T>::begin_leaf(const VdbPlace& origin, LeafMask& mask) {
    mask.load(stream_);
    if (version_ >= vdb_of_masks) return;
    if (stream_.number<VdbPlace>() != origin || stream_.number<std::int8_t>() != 1)
        refuse("has a leaf that lies elsewhere than its tree says, or has several values a voxel");
}

template <class T>
void VdbTree<T>::put_leaf(const VdbPlace& origin, const VdbWindow<T>& window) {
    LeafMask mask;
    std::array<T, leaf_size> values;
    begin_leaf(origin, mask);
    read_values(mask, std::span<T>(values));
    put_cube(origin, leaf_edge, window, [&](int x, int y, int z) { return values[std::size_t(x * 64 + y * 8 + z)]; });
}

template <class T>
template <class Use>
void VdbTree<T>::each_leaf(const Use& use) {
    stream_.go_to(grid_.blocks);
    for (Leaf& leaf : leaves_) use(leaf);
    if (stream_.position() != grid_.end)
        refuse(fmt::format("has a grid '{}' whose values do not end where it does", grid_.name));
}

template <class T>
void VdbTree<T>::put_all_leaves(const VdbWindow<T>& window, const std::function<void(std::uint64_t)>& progress) {
    each_leaf([&](const Leaf& leaf) {
        put_leaf(leaf.origin, window);
        progress(stream_.position());
    });
}

template <class T>
void VdbTree<T>::find_leaves() {
    LeafMask mask;
    each_leaf([&](Leaf& leaf) {
        leaf.position = stream_.position();
        begin_leaf(leaf.origin, mask);
        stream_.go_to(values_here(mask, leaf_size).end);
    });
    std::ranges::sort(leaves_, {}, &Leaf::origin);
}

/// Of those that have been found.
template <class T>
template <class Use>
void VdbTree<T>::each_leaf_in(const VdbWindow<T>& window, const Use& use) const {
    VdbPlace first, last;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        constexpr std::int64_t most = INT32_MAX;
        first[axis] = int(window.first[axis]) & -leaf_edge;
        last[axis] = int(std::min(window.first[axis] + window.size[axis] - 1, most));
    }
    for (std::int64_t x = first[0]; x <= last[0]; x += leaf_edge)
        for (std::int64_t y = first[1]; y <= last[1]; y += leaf_edge) {
            auto leaf = std::ranges::lower_bound(leaves_, VdbPlace{int(x), int(y), first[2]}, {}, &Leaf::origin);
            for (; leaf != leaves_.end() && leaf->origin[0] == x && leaf->origin[1] == y && leaf->origin[2] <= last[2];
                 ++leaf)
                use(*leaf);
        }
}

template <class T>
void VdbTree<T>::put_leaves(const VdbWindow<T>& window) {
    each_leaf_in(window, [&](const Leaf& leaf) {
        stream_.go_to(leaf.position);
        put_leaf(leaf.origin, window);
    });
}

template <class T>
bool VdbTree<T>::is_empty(const VdbWindow<T>& window) const {
    bool is = true;
    each_leaf_in(window, [&](const Leaf&) { is = false; });
    VdbPlace begin, end;
    for (const Tiles& node : tiles_) is &= !overlap(node.origin, node.entries * node.tile_edge, window, begin, end);
    return is;
}

template <class T>
void VdbTree<T>::put_tiles(const VdbWindow<T>& window) const {
    const std::size_t count = std::size_t(window.size[0]) * std::size_t(window.size[1]) * std::size_t(window.size[2]);
    std::fill_n(window.voxels, count, background_);
    for (const Tiles& node : tiles_) {
        VdbPlace begin, end;
        if (!overlap(node.origin, node.entries * node.tile_edge, window, begin, end)) continue;
        std::size_t i = 0;
        for (int x = 0; x < node.entries; ++x)
            for (int y = 0; y < node.entries; ++y)
                for (int z = 0; z < node.entries; ++z, ++i)
                    if (const T value = node.values[i]; !is_background(value))
                        put_cube(moved(node.origin, x * node.tile_edge, y * node.tile_edge, z * node.tile_edge),
                                 node.tile_edge, window, [&](int, int, int) { return value; });
    }
}

template class VdbTree<float>;
template class VdbTree<double>;

}  // namespace chiaro::decode
