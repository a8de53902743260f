// Which grid of an OpenVDB file is the volume, where it lies in the file, and in the world. libopenvdb reads
// transforms; the file's table of contents and the metadata of grids are read here.
#pragma once
#include "decode/output.h"
#include "decode/vdb_stream.h"

#include <fmt/format.h>

#include <array>
#include <new>
#include <string>
#include <vector>

namespace chiaro::decode {

/// Versions of the file format that are read: OpenVDB 1.0 of 2012 and later.
inline constexpr std::uint32_t oldest_vdb = 220, newest_vdb = 224;
/// From this one on each grid tells how it is compressed, and nodes how their inactive values are.
inline constexpr std::uint32_t vdb_of_masks = 222;

inline constexpr const char *vdb_float_tree = "Tree_float_5_4_3", *vdb_double_tree = "Tree_double_5_4_3";

/// A grid by the file's table of contents.
struct VdbGrid {
    std::string name;                              ///< unique: the second "density" is "density[1]"
    std::string type;                              ///< of its tree
    std::string tree_of;                           ///< the grid whose tree it shares; empty: it has its own
    bool is_half = false;                          ///< its values are stored in 16 bits
    std::uint64_t begin = 0, blocks = 0, end = 0;  ///< bytes of the file: the grid, its leaves' values, what follows
};

struct VdbContents {
    std::uint32_t version = 0;      ///< of the file format
    std::uint32_t compression = 0;  ///< the library's flags, where grids have none of their own
    std::vector<VdbGrid> grids;
};

/// Throws Error{input} for what is no .vdb file, one of another version, one without grids or without a table of
/// contents, and one that is cut.
VdbContents read_contents(VdbStream& stream);

/// The grid that `part` names, or else the first that holds one float or double a voxel; a note tells of the others.
/// Throws Error{input} where there is none, or its values are others.
const VdbGrid& chosen_grid(const VdbContents& contents, const std::string& part, Volume& header);

/// The grid in which a grid's tree lies: itself, unless it shares another's.
const VdbGrid& owner_of_tree(const VdbContents& contents, const VdbGrid& grid);

/// What stands before a grid's tree.
struct VdbPlacement {
    bool is_level_set = false;
    std::uint32_t compression = 0;  ///< the library's flags
    std::array<Vec3, 3> steps;      ///< in the world, from voxel to voxel
    Vec3 origin;                    ///< of the centre of voxel (0, 0, 0)
};

/// Leaves the stream at the grid's tree. Throws Error{input} for transforms that are not affine or make no sense.
VdbPlacement read_placement(VdbStream& stream, const VdbContents& contents, const VdbGrid& grid);

/// Calls the library; what it throws of its own becomes "has WHAT that cannot be read".
template <class Call>
auto by_library(const char* what, const Call& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        refuse(fmt::format("has {} that cannot be read ({})", what, error.what()));
    }
}

}  // namespace chiaro::decode
