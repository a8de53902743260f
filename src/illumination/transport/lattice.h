// How the light grid lies in memory for sweeps along each axis: rows along a sweep's planes, so that neighbours in a
// row are neighbours in memory.
#pragma once
#include <span>
#include <vector>

#include "illumination/cells/grid.h"
#include "illumination/transport/field_memory.h"
#include "illumination/transport/light_kernel.h"
#include "illumination/visibility/sweep_plan.h"

namespace chiaro {

/// One float a cell, rows padded with zeros to sixteen.
using LatticeField = std::vector<float, FieldAllocator<float>>;

/// Rows along x (for sweeps along y and z), or along y (for those along x).
class Lattice {
public:
    Lattice(const std::array<int, 3>& count, bool along_y)
        : count_(count), along_y_(along_y), row_((count[along_y ? 1 : 0] + 15) / 16 * 16) {}

    bool along_y() const { return along_y_; }
    int row() const { return row_; }
    std::size_t size() const { return std::size_t(row_) * (along_y_ ? count_[0] : count_[1]) * count_[2]; }
    std::size_t index(int x, int y, int z) const {
        return along_y_ ? (std::size_t(x) * count_[2] + z) * row_ + y : (std::size_t(z) * count_[1] + y) * row_ + x;
    }
    const std::array<int, 3>& count() const { return count_; }
    LatticeField field() const { return LatticeField(size(), 0.0f); }
    /// Holding anything.
    LatticeField unset_field() const { return LatticeField(size()); }

private:
    std::array<int, 3> count_;
    bool along_y_;
    int row_;
};

/// Where the numbers of a grid's cells lie in its two lattices.
inline kernel::CellPlaces cell_places(const Lattice& along_x, const Lattice& along_y) {
    const auto [nx, ny, nz] = along_x.count();
    return {nx, ny, nz, along_x.row(), along_y.row()};
}

/// A slice of constant z from one lattice to the other.
void copy_slice(const Lattice& from, const float* source, const Lattice& to, float* target, int z);

/// A grid's values, x fastest, as a lattice and back.
LatticeField spread(const CellGrid& grid, const float* values, const Lattice& lattice);

}  // namespace chiaro
