// Seeds of formats that keep voxels in chunks or trees.
#pragma once
#include "hostile/seeds.h"

namespace hostile {

void add_hdf5(std::vector<Seed>& all);
/// An array's folder: each of its files is damaged while the others are whole.
void add_zarr(std::vector<Seed>& all);
/// None where this build has no decoder for them.
void add_vdb(std::vector<Seed>& all);

}  // namespace hostile
