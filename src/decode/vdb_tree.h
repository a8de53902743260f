// A tree of voxels: what OpenVDB's "5_4_3" is, read node by node. Nothing of a file is believed before it is checked:
// the library, which decompresses values, writes and allocates what the file says.
//
// A node of 32³ entries, each a node of 16³, or one value for 128³ voxels; of which each is a leaf of 8³ voxels, or one
// value for 8³. The structure lies together, the leaves' values behind it, in the same order. Entries are counted with
// z fastest.
#pragma once
#include <openvdb/util/NodeMasks.h>

#include <cstring>
#include <functional>
#include <span>

#include "decode/vdb_file.h"

namespace chiaro::decode {

using VdbPlace = std::array<int, 3>;

/// Voxels from `first` to `last`, both within.
struct VdbBox {
    std::array<std::int64_t, 3> first{INT64_MAX, INT64_MAX, INT64_MAX}, last{INT64_MIN, INT64_MIN, INT64_MIN};

    bool is_empty() const { return first[0] > last[0]; }
    void add(const VdbPlace& origin, const VdbPlace& end);  ///< `end`: its last voxel
};

/// A part of the volume in memory, x fastest.
template <class T>
struct VdbWindow {
    std::array<std::int64_t, 3> first;  ///< its voxel there
    std::array<int, 3> size;            ///< of the part
    T* voxels;
};

/// Where the values of a node lie in the file, and how many bytes they are.
struct VdbBlock {
    std::uint64_t begin = 0, end = 0, values = 0;
    bool is_packed = false;
};

template <class T>
class VdbTree {
public:
    /// Reads the structure from where the stream stands. Throws Error{input}.
    VdbTree(VdbStream& stream, std::uint32_t version, const VdbGrid& grid, std::uint32_t compression);
    VdbTree(const VdbTree&) = delete;
    VdbTree& operator=(const VdbTree&) = delete;

    /// Of what is active.
    const VdbBox& box() const { return box_; }

    /// The voxels of a window that lie in no leaf.
    void put_tiles(const VdbWindow<T>& window) const;
    /// All leaves' voxels; `progress` is told the byte of the file that is come to. Throws Error{input} where their
    /// values do not end with the grid.
    void put_all_leaves(const VdbWindow<T>& window, const std::function<void(std::uint64_t)>& progress);

    /// Finds where the values of leaves lie, without decompressing them; throws as put_all_leaves.
    void find_leaves();
    /// Those that lie in the window.
    void put_leaves(const VdbWindow<T>& window);
    /// Whether all of a window is known to be the background: no leaf lies in it, nor a node with other values.
    bool is_empty(const VdbWindow<T>& window) const;

private:
    static constexpr int leaf_edge = 8, leaf_size = 512, root_edge = 4096;
    using LeafMask = openvdb::util::NodeMask<3>;

    struct Leaf {
        VdbPlace origin;
        std::uint64_t position = 0;  ///< in the file, of its values, once they are found
    };
    /// A node whose entries are not all nodes or the background; or a value of the root, with one entry.
    struct Tiles {
        VdbPlace origin;
        int entries = 1;    ///< along an edge
        int tile_edge = 0;  ///< voxels
        std::vector<T> values;
    };

    void read_root();
    template <unsigned log2>
    void read_node(const VdbPlace& origin, std::vector<Leaf>& leaves);
    template <class Mask>
    VdbBlock values_here(const Mask& mask, std::size_t count);
    void check_zlib(const VdbBlock& block);
    template <class Mask>
    void read_values(const Mask& mask, std::span<T> to);
    void begin_leaf(const VdbPlace& origin, LeafMask& mask);
    void put_leaf(const VdbPlace& origin, const VdbWindow<T>& window);
    template <class Use>
    void each_leaf(const Use& use);
    template <class Use>
    void each_leaf_in(const VdbWindow<T>& window, const Use& use) const;
    bool is_background(T value) const { return std::memcmp(&value, &background_, sizeof value) == 0; }

    VdbStream& stream_;
    VdbGrid grid_;
    std::uint32_t version_, compression_;
    T background_{};
    VdbBox box_;
    std::vector<Tiles> tiles_;
    std::vector<Leaf> leaves_;  ///< in the order of the file; once found, of their origins
};

extern template class VdbTree<float>;
extern template class VdbTree<double>;

}  // namespace chiaro::decode
