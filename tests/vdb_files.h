// Grids, written by OpenVDB's library and read again by it.
#pragma once
#include "volume_files.h"

#pragma GCC visibility push(default)  // its templates keep what they share with the library in variables of their own
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#pragma GCC visibility pop

namespace volume_files {

using openvdb::Coord, openvdb::CoordBBox;

inline void write_vdb(const fs::path& path, const openvdb::GridPtrVec& grids,
                      std::uint32_t compression = openvdb::io::Archive::DEFAULT_COMPRESSION_FLAGS) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.setCompression(compression);
    file.write(grids);
    file.close();
}

/// As the library reads it.
template <class GridT>
typename GridT::Ptr read_vdb(const fs::path& path, const std::string& name) {
    openvdb::io::File file(path.string());
    file.open(false);
    return openvdb::gridPtrCast<GridT>(file.readGrid(name));
}

/// Voxels of three leaves with inactive ones among them that have values of their own, active cubes that are one value,
/// and an inactive one; at negative places too. `edge`: of the largest cube, 8 or 128.
template <class GridT>
typename GridT::Ptr some_grid(const std::string& name, double background, int edge = 8) {
    using T = typename GridT::ValueType;
    openvdb::initialize();
    const auto grid = GridT::create(T(background));
    grid->setName(name);
    auto voxels = grid->getAccessor();
    for (int i = 0; i < 300; ++i) {
        voxels.setValue(Coord(-13 + i % 7, -3 + i % 11, 2 + i % 5), T(0.1 * i - 7));
        voxels.setValueOff(Coord(20 + i % 3, i % 8, i % 8), T(1000 + i % 2));
    }
    voxels.setValue(Coord(22, 4, 6), T(-0.37));
    grid->tree().addTile(edge == 8 ? 1 : 2, Coord(edge, 0, -edge), T(2.75), true);
    grid->tree().addTile(1, Coord(-8, 8, 8), T(0.1), true);
    grid->tree().addTile(1, Coord(-8, 8, 0), T(-5), false);
    return grid;
}

/// All voxels of the box around what is active, x fastest.
template <class GridT>
std::vector<typename GridT::ValueType> voxels_of(const GridT& grid) {
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const auto voxels = grid.getConstAccessor();
    std::vector<typename GridT::ValueType> values;
    const Coord size = box.dim();
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x) values.push_back(voxels.getValue(box.min() + Coord(x, y, z)));
    return values;
}

}  // namespace volume_files
