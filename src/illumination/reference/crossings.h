// What a ray in one direction crosses, from the same place in any cell: cells and lengths (Amanatides and Woo 1987).
#pragma once
#include <chiaro/geometry.h>

#include "illumination/reference/extinction.h"
#include "illumination/reference/kernel.h"

namespace chiaro {

class Crossings {
public:
    explicit Crossings(const ExtinctionCells& cells);

    /// Lists the crossings of a ray from a cell at `x` (its place among the interleaved ones matters) until it has left
    /// the grid, wherever it started. Rays leave a point that lies `offset` (at most ½ per axis, in edges) off the
    /// cell's centre. Returns what the kernel reads; it is valid until the next call.
    kernel::CellRays along(Vec3 direction, int x, double start_half_voxels, Vec3 offset = {});

    /// What the last call's answer points into, but for the cells.
    void add_to(HostArrays& arrays) const {
        arrays.add(list_);
        for (const auto& beyond : beyond_) arrays.add(beyond);
    }
    const ExtinctionCells& cells() const { return cells_; }

private:
    const ExtinctionCells& cells_;
    std::vector<kernel::Crossing> list_;
    std::array<std::vector<std::int32_t>, 3> beyond_;
};

}  // namespace chiaro
