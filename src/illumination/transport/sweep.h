// One group of directions on its way through all planes of the light grid.
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include "illumination/transport/lattice.h"
#include "illumination/transport/opaque.h"
#include "illumination/transport/sweep_kernel.h"

namespace chiaro {

/// The two lattices of a grid.
struct Lattices {
    Lattice along_x, along_y;

    explicit Lattices(const std::array<int, 3>& count) : along_x(count, false), along_y(count, true) {}
    const Lattice& of(const SweepAxes& axes) const { return axes.major == 0 ? along_y : along_x; }
};

/// A field in both orders.
struct BothWays {
    LatticeField along_x, along_y;

    const float* of(const SweepAxes& axes) const { return (axes.major == 0 ? along_y : along_x).data(); }
};

/// The side of a cube of which a sweep's light comes: 0: +x, 1: -x, 2: +y ...
inline int side_of(const SweepAxes& axes) { return 2 * axes.major + (axes.sign < 0); }

/// What travels from plane to plane: `fields` planes of cells with a halo that holds what comes from outside.
class TravellingPlanes {
public:
    TravellingPlanes(int nu, int nv, int fields, float outside)
        : row_((nu + 15) / 16 * 16 + 2 * margin), field_(std::int64_t(row_) * (nv + 2)) {
        for (auto& plane : planes_) plane.assign(std::size_t(field_) * std::size_t(fields), outside);
    }
    int row() const { return row_; }
    std::int32_t place(int v) const { return (v + 1) * row_ + margin; }
    /// After so many planes.
    kernel::SweepPlane view(int k) { return {planes_[(k + 1) & 1].data(), planes_[k & 1].data(), field_}; }

private:
    static constexpr int margin = 8;
    std::vector<float> planes_[2];
    int row_;
    std::int64_t field_;
};

/// The rays of a batch as the kernels know them.
std::vector<kernel::SweepRay> sweep_rays(const std::vector<Vec3>& directions, std::span<const SweepDirection> batch,
                                         const SweepAxes& axes, int row, const OpaqueCells& opaque);

/// A row of a plane: where it lies in its lattice, and which opaque cells it holds.
struct SweptRow {
    int v;
    std::size_t at;  ///< in a field of the lattice
    kernel::OpaqueRow opaque;
};

/// Calls visit(k, row) for the rows of one plane after the other, k planes from the light's side. Returns early once
/// cancelled.
template <class Visit>
void for_each_row(const Lattice& lattice, const SweepAxes& axes, const OpaqueCells& cells, const float* emission,
                  float* arriving, const Progress& progress, const Visit& visit) {
    const auto& n = lattice.count();
    const int steps = n[axes.major];
    for (int k = 0; k < steps && !progress.cancelled(); ++k) {
        const int plane = axes.sign > 0 ? steps - 1 - k : k;
        for (int v = 0; v < n[axes.v]; ++v) {
            std::array<int, 3> first{0, 0, 0};
            first[axes.major] = plane, first[axes.v] = v;
            const auto [x, y, z] = first;
            const auto opaque = lattice.along_y() ? cells.row(lattice, x, z) : cells.row(lattice, y, z);
            visit(k,
                  SweptRow{v,
                           lattice.index(x, y, z),
                           {opaque.data(), std::int32_t(opaque.size()), cells.clear_cells() + cells.bit_index(x, y, z),
                            cells.stride(axes.u), emission, arriving}});
        }
    }
}

}  // namespace chiaro
